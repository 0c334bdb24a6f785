// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"
#include "modules/slam2d/scan/view.hpp"

namespace nodmap::slam2d {

/// Points, or their normals, that never change. Copies share them, so that a map of thousands of
/// keyframes is copied at little cost.
class SharedPoints {
 public:
  SharedPoints() = default;
  explicit SharedPoints(std::vector<Eigen::Vector2f> points)
      : points_(std::make_shared<const std::vector<Eigen::Vector2f>>(std::move(points))) {}

  [[nodiscard]] std::size_t size() const { return points_ ? points_->size() : 0; }
  [[nodiscard]] const Eigen::Vector2f* begin() const { return points_ ? points_->data() : nullptr; }
  [[nodiscard]] const Eigen::Vector2f* end() const { return begin() + size(); }
  [[nodiscard]] const Eigen::Vector2f& operator[](std::size_t i) const { return (*points_)[i]; }

  friend bool operator==(const SharedPoints& a, const SharedPoints& b) {
    return std::ranges::equal(a, b);
  }

 private:
  std::shared_ptr<const std::vector<Eigen::Vector2f>> points_;  // null: none
};

/// A scan that was added to the map. It is kept so that its pose can be corrected later, and grids
/// can be drawn from it.
struct Keyframe {
  time::Timestamp stamp{};
  /// In the odom frame of the first keyframe: after a restart, odometry continues from where it
  /// was.
  geometry::SE2 T_odom_base;
  geometry::SE2 T_map_base;
  Eigen::Vector2d sensor_origin_base = Eigen::Vector2d::Zero();
  SharedPoints points_base = {};
  SharedPoints normals_base = {};  ///< of each point; zero where it is not known
};

/// Gives a keyframe its points.
void set_points(Keyframe& keyframe, std::span<const OrientedPoint> points_base);

/// The points of a keyframe with their normals, in base.
[[nodiscard]] std::vector<OrientedPoint> oriented_points(const Keyframe& keyframe);

/// At most about 120 of the points, spread over the scan: enough to match it.
[[nodiscard]] std::vector<OrientedPoint> some_points(const Keyframe& keyframe);

[[nodiscard]] View view_of(const Keyframe& keyframe);

}  // namespace nodmap::slam2d
