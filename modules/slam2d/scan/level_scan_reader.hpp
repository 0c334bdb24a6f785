// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/sensor_input.hpp"
#include "modules/slam2d/scan/level_scan_input.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam2d {

/// Reads level scans from SCAN and ODOMETRY messages, or virtual ones from STRUCTURE_MAP instead of
/// SCAN. Counts the odometry that it uses and all messages that it rejects: those of SensorInput,
/// and `scan_without_odometry`.
class LevelScanReader {
 public:
  /// `bus`: see SensorInput.
  LevelScanReader(const LevelScanParams& params, node::MessageCounts& counts,
                  const bus::Bus* bus = nullptr)
      : counts_(counts),
        messages_(counts, bus),
        input_(params),
        uses_structure_map_(params.from_structure_map),
        structure_period_(time::from_seconds(params.structure_period_s)) {}

  void read(const nodmap::odometry_t& message);
  void read(const nodmap::scan_t& message);
  /// The virtual scan of a structure map, valid until the next call, if one is due
  /// (level_scans.from_structure_map).
  [[nodiscard]] std::optional<LevelScan> read(const nodmap::egomap_t& message);
  /// The next level scan; valid until the next call. To be called after each scan until it returns
  /// none: while odometry comes late, level scans wait.
  [[nodiscard]] std::optional<LevelScan> next();
  /// To be called when no scan comes any more: next() then returns what waited for more of them.
  void end_scans() { input_.end_scans(); }
  /// To be called at the end: counts the level scans that still wait as rejected.
  void finish();

  /// Of the last plausible scan, level or not, with odometry or without.
  [[nodiscard]] time::Timestamp scan_stamp() const { return scan_stamp_; }
  [[nodiscard]] const LevelScanInput& input() const { return input_; }

 private:
  void reject_without_odometry();

  node::MessageCounts& counts_;
  node::SensorInput messages_;
  LevelScanInput input_;
  bool uses_structure_map_;
  time::Duration structure_period_;
  std::optional<time::Timestamp> last_structure_map_;  // that was used
  std::int64_t without_odometry_ = 0;                  // counted so far
  scan::Scan scan_;                                    // the last one; a member to reuse its memory
  time::Timestamp scan_stamp_{};
};

}  // namespace nodmap::slam2d
