// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/ground.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/se2.hpp"

namespace nodmap::sim {
namespace {

double slope_of(const Ramp& ramp) {
  const Eigen::Vector3d along = ramp.to - ramp.from;
  return along.z() / along.head<2>().norm();
}

std::optional<double> height_at(const Ramp& ramp, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along = (ramp.to - ramp.from).head<2>();
  const Eigen::Vector2d direction = along.normalized();
  const Eigen::Vector2d v = p - ramp.from.head<2>();
  const double ahead = v.dot(direction);
  const double left = direction.x() * v.y() - direction.y() * v.x();
  if (ahead < 0.0 || ahead > along.norm() || std::abs(left) > 0.5 * ramp.width_m) {
    return std::nullopt;
  }
  return ramp.from.z() + slope_of(ramp) * ahead;
}

std::optional<double> height_at(const Box& box, const Eigen::Vector2d& p) {
  const geometry::SE2 T_world_box{box.center.x(), box.center.y(), box.yaw_rad};
  const Eigen::Vector2d q = T_world_box.inverse() * p;
  if (std::abs(q.x()) > 0.5 * box.size.x() || std::abs(q.y()) > 0.5 * box.size.y()) {
    return std::nullopt;
  }
  return box.center.z() + 0.5 * box.size.z();
}

}  // namespace

bool is_drivable(const Ramp& ramp, const BodyParams& params) {
  return std::abs(slope_of(ramp)) <= std::tan(params.max_slope_rad);
}

Ground::Ground(const World& world, const BodyParams& params)
    : climb_height_m_(params.climb_height_m), body_height_m_(params.height_m) {
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const Object& object = world.objects[i];
    if (const auto* ramp = std::get_if<Ramp>(&object.shape)) {
      if (is_drivable(*ramp, params)) {
        ramps_.push_back({*ramp, i});
      }
    } else if (const auto* box = std::get_if<Box>(&object.shape)) {
      if (box->center.z() + 0.5 * box->size.z() > climb_height_m_) {
        platforms_.push_back(*box);
      }
    }
  }
  // Without ramps no platform can be reached.
  if (ramps_.empty()) {
    platforms_.clear();
  }
}

WheelContact Ground::roll(const Eigen::Vector2d& p, double height_m) const {
  WheelContact contact;
  const double step_m = height_m + climb_height_m_;
  for (const Slope& slope : ramps_) {
    const std::optional<double> found_m = height_at(slope.ramp, p);
    if (found_m && *found_m <= step_m) {
      contact.height_m = std::max(contact.height_m, *found_m);
    } else if (found_m && *found_m < height_m + body_height_m_) {
      contact.blocking_object = slope.object;
    }
  }
  for (const Box& platform : platforms_) {
    const std::optional<double> found_m = height_at(platform, p);
    if (found_m && *found_m <= step_m) {
      contact.height_m = std::max(contact.height_m, *found_m);
    }
  }
  return contact;
}

}  // namespace nodmap::sim
