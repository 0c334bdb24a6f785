// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/ground/tracked_ground.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kCellM = 0.2;
constexpr int kLog2Size = 6;
// A facet flatter than this counts as level: twice the error of a ramp's tilt.
const double kLevelSlope = std::tan(geometry::deg_to_rad(2.0));
// Ground within this many cells counts as ground at the robot.
constexpr int kAroundCells = 8;
// Greatest change of the ground under a wheel from scan to scan: 2 cm of travel on the steepest
// ramp change it by 5 mm. A larger difference belongs to the ground beside the wheel's ramp.
constexpr double kWheelStepM = 0.03;

// The number of a facet once another one is gone.
std::size_t renumbered(std::size_t facet, std::size_t dropped) {
  return facet > dropped ? facet - 1 : facet;
}

}  // namespace

TrackedGround::TrackedGround(const GroundParams& params)
    : params_(params),
      max_slope_(std::tan(params.max_slope_rad)),
      facets_(1),
      cells_(kCellM, kLog2Size) {
  facets_.front().is_fixed = true;
}

// The ground under the wheels is known. A robot that has driven fast has seen none between its
// front and what the lowest beams meet once it stops, which may be a ramp that begins in between.
void TrackedGround::move(const geometry::SE2& T_odom_base) {
  cells_.center_on(T_odom_base.translation());
  for (std::size_t i = 0; i < under_wheels_.size(); ++i) {
    const Eigen::Vector2d wheel(i < 2 ? 0.5 : -0.5, i % 2 == 0 ? 0.5 : -0.5);
    const Eigen::Vector2d p_odom =
        T_odom_base * Eigen::Vector2d(params_.wheelbase_m * wheel.x(), params_.track_m * wheel.y());
    if (facets_.size() > 1) {
      under_wheels_[i] = under_wheel(p_odom, under_wheels_[i].height_m);
    }
    const std::size_t facet = under_wheels_[i].facet;
    facets_[facet].is_fixed = true;
    join(p_odom, facet);
  }
  if (facets_.size() == 1) {
    T_odom_base_ = geometry::to_se3(T_odom_base);
    return;
  }
  const double front_left = under_wheels_[0].height_m;
  const double front_right = under_wheels_[1].height_m;
  const double rear_left = under_wheels_[2].height_m;
  const double rear_right = under_wheels_[3].height_m;
  const Eigen::Vector2d rise_base(
      0.5 * (front_left + front_right - rear_left - rear_right) / params_.wheelbase_m,
      0.5 * (front_left + rear_left - front_right - rear_right) / params_.track_m);
  const Eigen::Vector2d rise = T_odom_base.rotation() * rise_base;
  const double height_m = 0.25 * (front_left + front_right + rear_left + rear_right);
  const Eigen::Vector3d up(-rise.x(), -rise.y(), 1.0);
  T_odom_base_ = geometry::make_se3(
      {T_odom_base.x, T_odom_base.y, height_m},
      geometry::rotation_between(Eigen::Vector3d::UnitZ(), up) *
          Eigen::Quaterniond(Eigen::AngleAxisd(T_odom_base.yaw, Eigen::Vector3d::UnitZ())));
  under_base_ = under_wheel(T_odom_base.translation(), height_m).facet;
  is_level_ = level_around(T_odom_base.translation());
}

bool TrackedGround::level_around(const Eigen::Vector2d& p_odom) const {
  unsigned mask = 1U << under_base_;
  const Eigen::Vector2i middle = cells_.index_of(p_odom);
  for (int dx = -kAroundCells; dx <= kAroundCells; ++dx) {
    for (int dy = -kAroundCells; dy <= kAroundCells; ++dy) {
      mask |= cells_.at(middle + Eigen::Vector2i(dx, dy));
    }
  }
  return mask == 1U << under_base_ && facets_[under_base_].plane.slope.isZero();
}

// The facets seen in the cell of a place and the eight around it.
TrackedGround::Mask TrackedGround::mask_at(const Eigen::Vector2d& p_odom) const {
  const Eigen::Vector2i middle = cells_.index_of(p_odom);
  unsigned mask = 0;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      mask |= cells_.contains(index) ? cells_.at(index) : 0U;
    }
  }
  return static_cast<Mask>(mask);
}

// The ground at a place where these facets were seen. A facet that rises from another one is the
// ground where it is higher than that; one that falls, where it is lower. Facets that meet
// otherwise do so at the foot of a ramp. They are in the order in which they were found.
TrackedGround::Ground TrackedGround::ground_of(Mask mask, const Eigen::Vector2d& p_odom) const {
  if (mask == 0) {
    return {facets_[under_base_].plane.at(p_odom), under_base_};
  }
  Ground ground{0.0, facets_.size()};
  for (std::size_t i = 0; i < facets_.size(); ++i) {
    if ((mask >> i & 1U) == 0) {
      continue;
    }
    const Facet& facet = facets_[i];
    const double height_m = facet.plane.at(p_odom);
    const bool is_first = ground.facet == facets_.size();
    const bool rises = facet.rises || (mask >> facet.before & 1U) == 0;
    if (is_first || (height_m > ground.height_m) == rises) {
      ground = {height_m, i};
    }
  }
  return ground;
}

TrackedGround::Ground TrackedGround::under_wheel(const Eigen::Vector2d& p_odom,
                                                 double last_m) const {
  const Mask mask = mask_at(p_odom);
  Ground ground = ground_of(mask, p_odom);
  if (std::abs(ground.height_m - last_m) <= kWheelStepM) {
    return ground;
  }
  for (std::size_t i = 0; i < facets_.size(); ++i) {
    const double height_m = facets_[i].plane.at(p_odom);
    if ((mask >> i & 1U) != 0 && std::abs(height_m - last_m) < std::abs(ground.height_m - last_m)) {
      ground = {height_m, i};
    }
  }
  return ground;
}

TrackedGround::Place TrackedGround::look(const Eigen::Vector3d& p_odom, double tolerance_m) const {
  using Kind = Place::Kind;
  const Eigen::Vector2d p = p_odom.head<2>();
  const Mask mask = facets_.size() == 1 ? Mask{1} : mask_at(p);
  const Ground ground = ground_of(mask, p);
  const double height_m = p_odom.z() - ground.height_m;
  if (std::abs(height_m) <= tolerance_m) {
    return {Kind::kGround, height_m, ground.facet};
  }
  if (height_m > 0.0) {
    return {Kind::kAbove, height_m, ground.facet};
  }
  // Beside a ramp: the level floor under the robot, and the side of the ramp. A ramp under the
  // robot does not go on below the ground at its foot: what is there is a hole.
  const Plane& own = facets_[under_base_].plane;
  if ((mask >> under_base_ & 1U) != 0 && under_base_ != ground.facet && own.slope.isZero()) {
    const double above_own_m = p_odom.z() - own.at(p);
    if (above_own_m >= -tolerance_m) {
      return {above_own_m <= tolerance_m ? Kind::kGround : Kind::kAbove, above_own_m, under_base_};
    }
  }
  return {Kind::kBelow, height_m, ground.facet};
}

std::optional<std::size_t> TrackedGround::known_facet_at(const Eigen::Vector2d& p_odom) const {
  const Mask mask = mask_at(p_odom);
  return mask == 0 ? std::nullopt : std::optional(ground_of(mask, p_odom).facet);
}

double TrackedGround::height_m(const Eigen::Vector2d& p_odom) const {
  return facets_.size() == 1 ? 0.0 : ground_of(mask_at(p_odom), p_odom).height_m;
}

void TrackedGround::grow(const Eigen::Vector2d& p_odom, std::size_t facet) {
  if ((mask_at(p_odom) >> facet & 1U) != 0) {
    join(p_odom, facet);
  }
}

void TrackedGround::join(const Eigen::Vector2d& p_odom, std::size_t facet) {
  const Eigen::Vector2i index = cells_.index_of(p_odom);
  if (!cells_.contains(index) || (cells_.at(index) >> facet & 1U) != 0) {
    return;
  }
  cells_.at(index) = static_cast<Mask>(cells_.at(index) | 1U << facet);
  if (facets_.size() > 1) {
    joined_.push_back({cells_.center_of(index), !facets_[facet].is_fixed});
  }
}

std::vector<TrackedGround::Joined> TrackedGround::take_joined() {
  return std::exchange(joined_, {});
}

void TrackedGround::refine(std::size_t facet, const Eigen::Vector3d& p_odom) {
  Facet& f = facets_[facet];
  if (f.is_fixed) {
    return;
  }
  f.fit.add(p_odom);
  if (const auto plane = f.fit.solve()) {
    f.plane = *plane;
    if (plane->slope.norm() < kLevelSlope) {
      f.plane = f.fit.level();
    }
  }
}

std::size_t TrackedGround::add_facet(const PlaneFit& fit, std::size_t before, bool rises) {
  if (facets_.size() == kMaxFacets) {
    const std::size_t dropped = drop_facet_other_than(before);
    before -= before > dropped ? 1 : 0;
  }
  if (facets_.size() == 1) {
    under_wheels_.fill({});
  }
  Facet facet;
  facet.fit = fit;
  facet.before = before;
  facet.plane = *fit.solve();
  facet.rises = rises;
  if (facet.plane.slope.norm() < kLevelSlope) {
    facet.plane = fit.level();
  }
  facets_.push_back(facet);
  is_level_ = false;
  return facets_.size() - 1;
}

bool TrackedGround::is_under_robot(std::size_t facet) const {
  return facet == under_base_ || std::ranges::any_of(under_wheels_, [&](const Ground& ground) {
           return ground.facet == facet;
         });
}

// Drops the oldest facet that the robot is neither on, with any wheel, nor about to reach. Its
// cells are unknown until they are seen as ground again.
std::size_t TrackedGround::drop_facet_other_than(std::size_t kept) {
  std::size_t dropped = 0;
  while (is_under_robot(dropped) || dropped == kept) {
    ++dropped;
  }
  facets_.erase(facets_.begin() + static_cast<std::ptrdiff_t>(dropped));
  under_base_ = renumbered(under_base_, dropped);
  for (Ground& ground : under_wheels_) {
    ground.facet = renumbered(ground.facet, dropped);
  }
  for (Facet& facet : facets_) {
    if (facet.before == dropped) {
      facet.before = kNone;
    } else if (facet.before != kNone) {
      facet.before = renumbered(facet.before, dropped);
    }
  }
  for (int row = 0; row < cells_.size(); ++row) {
    for (int column = 0; column < cells_.size(); ++column) {
      Mask& mask = cells_.at_offset(column, row);
      const unsigned lower = mask & ((1U << dropped) - 1U);
      const unsigned higher = static_cast<unsigned>(mask) >> (dropped + 1) << dropped;
      mask = static_cast<Mask>(lower | higher);
    }
  }
  return dropped;
}

}  // namespace nodmap::navigator
