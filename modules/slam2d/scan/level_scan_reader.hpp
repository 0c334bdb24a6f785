// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/sensor_input.hpp"
#include "modules/slam2d/scan/level_scan_input.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam2d {

/// Reads level scans from SCAN and ODOMETRY messages. Counts the odometry that it uses and all
/// messages that it rejects: those of SensorInput, and `scan_without_odometry`.
class LevelScanReader {
 public:
  /// `bus`: see SensorInput.
  LevelScanReader(const LevelScanParams& params, node::MessageCounts& counts,
                  const bus::Bus* bus = nullptr)
      : counts_(counts), messages_(counts, bus), input_(params) {}

  void read(const nodmap::odometry_t& message);
  void read(const nodmap::scan_t& message);
  /// The next level scan; valid until the next call. To be called after each scan until it returns
  /// none: while odometry comes late, level scans wait.
  [[nodiscard]] std::optional<LevelScan> next();
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
  std::int64_t without_odometry_ = 0;  // counted so far
  scan::Scan scan_;                    // the last one; a member to reuse its memory
  time::Timestamp scan_stamp_{};
};

}  // namespace nodmap::slam2d
