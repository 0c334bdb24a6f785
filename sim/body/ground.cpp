// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/ground.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "common/geometry/se2.hpp"

namespace nodmap::sim {
namespace {

double slope_of(const Ramp& ramp) {
  const Eigen::Vector3d along = ramp.to - ramp.from;
  return along.z() / along.head<2>().norm();
}

std::optional<Support> support_of(const Ramp& ramp, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along = (ramp.to - ramp.from).head<2>();
  const Eigen::Vector2d direction = along.normalized();
  const Eigen::Vector2d v = p - ramp.from.head<2>();
  const double ahead = v.dot(direction);
  const double left = direction.x() * v.y() - direction.y() * v.x();
  if (ahead < 0.0 || ahead > along.norm() || std::abs(left) > 0.5 * ramp.width_m) {
    return std::nullopt;
  }
  const double slope = slope_of(ramp);
  const Eigen::Vector3d normal(-slope * direction.x(), -slope * direction.y(), 1.0);
  return Support{ramp.from.z() + slope * ahead, normal.normalized()};
}

std::optional<Support> support_of(const Box& box, const Eigen::Vector2d& p) {
  const geometry::SE2 T_world_box{box.center.x(), box.center.y(), box.yaw_rad};
  const Eigen::Vector2d q = T_world_box.inverse() * p;
  if (std::abs(q.x()) > 0.5 * box.size.x() || std::abs(q.y()) > 0.5 * box.size.y()) {
    return std::nullopt;
  }
  return Support{box.center.z() + 0.5 * box.size.z(), Eigen::Vector3d::UnitZ()};
}

}  // namespace

bool is_drivable(const Ramp& ramp, const BodyParams& params) {
  return std::abs(slope_of(ramp)) <= std::tan(params.max_slope_rad);
}

Ground::Ground(const World& world, const BodyParams& params)
    : climb_height_m_(params.climb_height_m) {
  for (const Object& object : world.objects) {
    if (const auto* ramp = std::get_if<Ramp>(&object.shape)) {
      if (is_drivable(*ramp, params)) {
        ramps_.push_back(*ramp);
      }
    } else if (const auto* box = std::get_if<Box>(&object.shape)) {
      if (box->center.z() + 0.5 * box->size.z() > climb_height_m_) {
        platforms_.push_back(*box);
      }
    }
  }
  // Without a ramp no platform can be reached.
  if (ramps_.empty()) {
    platforms_.clear();
  }
}

Support Ground::at(const Eigen::Vector2d& p, double height_m) const {
  Support highest;
  const auto consider = [&](const std::optional<Support>& support) {
    if (support && support->height_m <= height_m + climb_height_m_ &&
        support->height_m >= highest.height_m) {
      highest = *support;
    }
  };
  for (const Ramp& ramp : ramps_) {
    consider(support_of(ramp, p));
  }
  for (const Box& platform : platforms_) {
    consider(support_of(platform, p));
  }
  return highest;
}

}  // namespace nodmap::sim
