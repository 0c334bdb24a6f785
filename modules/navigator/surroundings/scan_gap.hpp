// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace nodmap::navigator {

/// A gap in the scans that is shorter than a sweep. After it the robot drives at half of its speed
/// bound until every place has been looked at again.
///
/// Why the robot need not stand and look: what it had looked at before is in its maps, and where no
/// floor was seen Brake stops it as always. Only what has come since could be missed. A gap hides
/// each place for one look, or for the two at one end of the sweep. So no place is unseen for
/// longer than twice the time for which the pitch controller allows its bound. At half of the bound
/// the robot drives no farther in that time than it may without a gap.
class ScanGap {
 public:
  /// `sweeps`: after so many every place has been looked at.
  explicit ScanGap(int sweeps) : sweeps_(sweeps) {}

  void reset() { *this = ScanGap(sweeps_); }

  /// Scans are missing. Returns false if they were missing just before, too: then a place may be
  /// missed again and again, and the robot must stand and look.
  [[nodiscard]] bool begin();

  /// Scans are there. `sweep_count`: reversals of the head.
  void update(std::int64_t sweep_count);

  /// The share of its speed bound at which the robot may drive.
  [[nodiscard]] double speed_ratio() const { return ended_at_sweep_ ? 0.5 : 1.0; }

 private:
  int sweeps_;
  bool is_open_ = false;
  std::optional<std::int64_t> ended_at_sweep_;  ///< empty once the laser has looked again
};

}  // namespace nodmap::navigator
