// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/body_clearance.hpp"

#include <algorithm>
#include <cmath>

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/people/foresight.hpp"

namespace nodmap::navigator {
namespace {

// The field of distances.
constexpr double kFieldCellM = 0.025;
constexpr double kFieldReachM = 2.5;
// Largest error of the clearance by cells: a cell of 2.5 cm stands for any point in it, and the
// discs do not cover all of the body.
constexpr double kCellErrorM = 0.035;
constexpr double kUncoveredM = 0.01;
// That error is larger than the margin of a creeping body. Below this clearance by cells, the
// clearance is measured to the points themselves, within kExactReachM, which a slow motion can
// reach.
constexpr double kExactWithinM = 0.1;
constexpr double kExactReachM = 0.5;

}  // namespace

BodyClearance::BodyClearance(const robot::Footprint& body) : body_(body) {
  const double length_m = body_.half_length_m;
  const double width_m = body_.half_width_m;
  const double radius_m = std::min(length_m, width_m);
  // So near to each other that between two discs they leave out no more than kUncoveredM.
  const double covered_m = std::max(0.0, radius_m - kUncoveredM);
  const double most_apart_m = 2.0 * std::sqrt(radius_m * radius_m - covered_m * covered_m);
  const double to_end_m = std::max(length_m, width_m) - radius_m;
  const int num_to_end = std::max(1, static_cast<int>(std::ceil(to_end_m / most_apart_m)));
  for (int i = -num_to_end; i <= num_to_end; ++i) {
    const double along = static_cast<double>(i) / num_to_end;
    discs_.push_back({{along * (length_m - radius_m), along * (width_m - radius_m)}, radius_m});
  }
  const double corner_m = 0.3 * radius_m;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      discs_.push_back({{x * (length_m - corner_m), y * (width_m - corner_m)}, corner_m});
      discs_.push_back({{x * length_m, y * width_m}, 0.0});
    }
  }
}

void BodyClearance::measure(const Points& points_base) {
  const int size = static_cast<int>(std::lround(2.0 * kFieldReachM / kFieldCellM));
  obstacles_.begin({-kFieldReachM, -kFieldReachM}, kFieldCellM, size, size);
  near_points_base_.clear();
  const double near_m = kExactReachM + body_.turning_radius_m() + kExactWithinM + kCellErrorM;
  for (const Eigen::Vector2d& p : points_base) {
    if (!is_error_of_map(p, body_)) {
      obstacles_.occupy(p);
      if (p.norm() < near_m) {
        near_points_base_.push_back(p);
      }
    }
  }
  obstacles_.compute();
}

double BodyClearance::at(const geometry::SE2& pose_base) const {
  const double rough_m = by_cells_m(pose_base);
  if (rough_m > kExactWithinM || pose_base.translation().norm() > kExactReachM) {
    return rough_m;
  }
  const Eigen::Matrix2d R_pose_base = pose_base.rotation().transpose();
  double clearance = rough_m + kCellErrorM;
  // What is farther from base than this is not nearer to the body than `clearance`.
  const double within_m = body_.turning_radius_m() + clearance;
  for (const Eigen::Vector2d& p_base : near_points_base_) {
    const Eigen::Vector2d step = p_base - pose_base.translation();
    if (step.squaredNorm() < within_m * within_m) {
      clearance = std::min(clearance, distance_to_body(R_pose_base * step, body_));
    }
  }
  return clearance;
}

double BodyClearance::by_cells_m(const geometry::SE2& pose_base) const {
  const double middle_m = obstacles_.at(pose_base.translation());
  const double circle_m = body_.turning_radius_m();
  if (middle_m > circle_m + 0.5) {
    return middle_m - circle_m;
  }
  const double c = std::cos(pose_base.yaw);
  const double s = std::sin(pose_base.yaw);
  double clearance = middle_m - std::min(body_.half_length_m, body_.half_width_m);
  for (const Disc& disc : discs_) {
    const Eigen::Vector2d p(pose_base.x + c * disc.center.x() - s * disc.center.y(),
                            pose_base.y + s * disc.center.x() + c * disc.center.y());
    clearance = std::min(clearance, obstacles_.at(p) - disc.radius_m);
  }
  return clearance;
}

}  // namespace nodmap::navigator
