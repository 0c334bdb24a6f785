// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/proximity.hpp"

namespace nodmap::navigator {

/// What the base's infrared range finders have measured beside and behind a robot that is still
/// where it was set down, and how far it may back up over ground that the laser has not seen. Three
/// beams look backwards: one straight along the middle of the body, two from its corners, 45
/// degrees outwards. What is narrower than half of the body may stand between them; no range finder
/// sees the floor.
class RearView {
 public:
  /// Without a reading nothing is nearer to the body than this.
  static constexpr double kReachM = 0.45;

  explicit RearView(const NavigatorParams& params) : unseen_m_(params.back_up.unseen_m) {}

  /// Adds readings; `T_odom_base` is the pose at `stamp`. The first ones are from where the robot
  /// was set down.
  void add(time::Timestamp stamp, const Proximity::Ranges& ranges_m,
           const geometry::SE2& T_odom_base);

  /// Whether the robot can rely on what is measured behind it: the three range finders have
  /// answered within the last 0.2 s. A base without range finders may answer like one that measures
  /// nothing, so one of the seven must have measured something.
  [[nodiscard]] bool is_looking(time::Timestamp now) const;

  /// How far the robot may still back up: `back_up.unseen_m` from where it was set down. 0 once it
  /// has been farther away.
  [[nodiscard]] double permitted_m(const geometry::SE2& T_odom_base) const;

  /// What was measured beside and behind the robot within the last ten seconds, in base.
  [[nodiscard]] Points points_base(const geometry::SE2& T_odom_base) const;

 private:
  struct Point {
    time::Timestamp stamp{};
    Eigen::Vector2d p_odom;
  };

  double unseen_m_;
  std::optional<Eigen::Vector2d> set_down_odom_;
  bool has_left_ = false;
  bool has_measured_ = false;
  std::optional<time::Timestamp> answered_at_;  // by all three that look backwards
  std::deque<Point> points_;                    // oldest first
};

}  // namespace nodmap::navigator
