// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/pose_update.hpp"

namespace nodmap::slam2d {

/// Doubt about odometry: whether the robot may be elsewhere than odometry says. It begins when the
/// robot is lost, and after a time without odometry, in which the robot may have driven on or been
/// carried. It ends when the robot's place is sure.
class Doubt {
 public:
  explicit Doubt(const DoubtParams& params) : params_(params) {}

  /// Begins, or increases, the doubt after a time without odometry.
  void begin(double odometry_gap_s);
  /// Begins the doubt after a time of which only odometry is known. `sigma_m`: standard deviation
  /// of the pose by odometry.
  void begin_by_odometry(double sigma_m);
  /// Takes the next pose. `is_sure`: every other place is excluded. Returns whether this ends the
  /// doubt.
  bool update(const PoseUpdate& update, bool is_sure);
  void end();

  [[nodiscard]] bool is_active() const { return reach_m_ > 0.0; }
  /// How far the robot may be from its pose by odometry, metres; 0: no doubt.
  [[nodiscard]] double reach_m() const { return reach_m_; }
  /// The standard deviation of the robot's position that corresponds to reach_m().
  [[nodiscard]] double sigma_m() const;
  /// How far from its pose by odometry its place is searched, metres.
  [[nodiscard]] double search_distance_m() const;
  /// Whether the robot may be where no search looks: then no place is sure.
  [[nodiscard]] bool exceeds_search() const { return reach_m_ > params_.search_distance_m; }
  /// The stamp of the first scan whose place was not sure, if there was one.
  [[nodiscard]] const std::optional<time::Timestamp>& since() const { return since_; }

 private:
  DoubtParams params_;
  double reach_m_ = 0.0;
  std::optional<time::Timestamp> since_;
};

}  // namespace nodmap::slam2d
