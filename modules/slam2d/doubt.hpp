// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"
#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// Whether the robot may be elsewhere than odometry says: after a while without odometry, in which
/// it may have been carried or have driven on, and while it is lost. Ends with a sure place.
class Doubt {
 public:
  explicit Doubt(const DoubtParams& params) : params_(params) {}

  /// After a time without odometry.
  void begin(double odometry_gap_s);
  /// `is_sure`: the robot can be nowhere else than at the pose of the update.
  void update(const PoseUpdate& update, bool is_sure);
  void end();

  [[nodiscard]] bool is_there() const { return reach_m_ > 0.0; }
  /// How far from where odometry says the robot may be, in metres; 0: no doubt.
  [[nodiscard]] double reach_m() const { return reach_m_; }
  /// The stamp of the first scan whose place was not sure, if there was one.
  [[nodiscard]] const std::optional<time::Timestamp>& since() const { return since_; }

 private:
  DoubtParams params_;
  double reach_m_ = 0.0;
  std::optional<time::Timestamp> since_;
};

}  // namespace nodmap::slam2d
