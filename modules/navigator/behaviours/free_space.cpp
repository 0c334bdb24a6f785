// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

constexpr int kHalf = FreeSpace::kHalf;
constexpr double kSoftnessM = 0.25;

struct Direction {
  double cos = 1.0;
  double sin = 0.0;
};

const std::array<Direction, 2 * kHalf + 1>& directions() {
  static const auto table = [] {
    std::array<Direction, 2 * kHalf + 1> made;
    for (int degree = -kHalf; degree <= kHalf; ++degree) {
      const double angle_rad = FreeSpace::angle_rad(degree);
      made[FreeSpace::index(degree)] = {std::cos(angle_rad), std::sin(angle_rad)};
    }
    return made;
  }();
  return table;
}

double preference(double phi_rad) {
  const double x = 1.2 * phi_rad;
  return std::abs(x) < 0.5 * geometry::kPi ? std::cos(x) : 0.0;
}

double openness(double distance_m, double open_space_m) {
  return 1.0 / (1.0 + std::exp(-(distance_m - open_space_m) / kSoftnessM));
}

// Shortens the free distance of all directions whose corridor contains the point.
void block(FreeSpace& space, const Eigen::Vector2d& p, const robot::Footprint& body,
           const robot::Footprint& corridor) {
  const double range_m = p.norm();
  const double bearing_deg = geometry::rad_to_deg(std::atan2(p.y(), p.x()));
  // One degree more than the corridor covers; whether the point is inside is decided below, without
  // rounding.
  const double half_deg =
      1.0 + geometry::rad_to_deg(std::asin(std::min(1.0, corridor.half_width_m / range_m)));
  const int first = std::max(-kHalf, static_cast<int>(std::ceil(bearing_deg - half_deg)));
  const int last = std::min(kHalf, static_cast<int>(std::floor(bearing_deg + half_deg)));
  for (int degree = first; degree <= last; ++degree) {
    const Direction& direction = directions()[FreeSpace::index(degree)];
    const double along_m = p.x() * direction.cos + p.y() * direction.sin;
    const double aside_m = std::abs(p.y() * direction.cos - p.x() * direction.sin);
    const bool ahead = along_m >= body.half_length_m && aside_m <= corridor.half_width_m;
    const bool under_body = along_m > 0.0 && aside_m < body.half_width_m;
    if (ahead || under_body) {
      space.at(degree) = std::min(space.at(degree), std::max(0.0, along_m - body.half_length_m));
    }
  }
}

}  // namespace

double FreeSpace::angle_rad(int degree) {
  return geometry::deg_to_rad(degree);
}

int FreeSpace::degree_of(double angle_rad) {
  const auto degree = static_cast<int>(std::lround(geometry::rad_to_deg(angle_rad)));
  return std::clamp(degree, -kHalf, kHalf);
}

FreeSpace measure_free_space(const Points& points_base, const robot::Footprint& body,
                             double side_margin_m) {
  FreeSpace space;
  space.distance_m.fill(std::numeric_limits<double>::infinity());
  const robot::Footprint corridor = body.grown(0.0, side_margin_m);
  for (const Eigen::Vector2d& p : points_base) {
    if (!is_error_of_map(p, body)) {
      block(space, p, body, corridor);
    }
  }
  return space;
}

std::optional<double> free_space_orientation(const FreeSpace& space, double wanted_rad,
                                             double open_space_m) {
  const auto weight = [&](int degree) {
    return preference(FreeSpace::angle_rad(degree) - wanted_rad) *
           openness(space.at(degree), open_space_m);
  };
  double sum_cos = weight(0);
  double sum_sin = 0.0;
  for (int degree = 1; degree <= kHalf; ++degree) {
    const double left = weight(degree);
    const double right = weight(-degree);
    const Direction& direction = directions()[FreeSpace::index(degree)];
    sum_cos += direction.cos * (left + right);
    sum_sin += direction.sin * (left - right);
  }
  // Directions that are shorter than the threshold by 10 softnesses weigh less than this together.
  if (std::hypot(sum_cos, sum_sin) < 1e-3) {
    return std::nullopt;
  }
  return std::atan2(sum_sin, sum_cos);
}

FreeNeighbours free_neighbours(const FreeSpace& space, double alpha_rad, double needed_m) {
  const int start = FreeSpace::degree_of(alpha_rad);
  if (space.at(start) >= needed_m) {
    return {alpha_rad, alpha_rad};
  }
  FreeNeighbours found;
  for (int degree = start + 1; degree <= kHalf && !found.left_rad; ++degree) {
    if (space.at(degree) >= needed_m) {
      found.left_rad = FreeSpace::angle_rad(degree);
    }
  }
  for (int degree = start - 1; degree >= -kHalf && !found.right_rad; --degree) {
    if (space.at(degree) >= needed_m) {
      found.right_rad = FreeSpace::angle_rad(degree);
    }
  }
  return found;
}

Side side_with_more_room(const FreeSpace& space) {
  constexpr double kFarM = 3.0;
  double left_minus_right_m = 0.0;
  for (int degree = 1; degree <= kHalf; ++degree) {
    left_minus_right_m += std::min(space.at(degree), kFarM) - std::min(space.at(-degree), kFarM);
  }
  return left_minus_right_m == 0.0 ? Side::kNone : side_of(left_minus_right_m);
}

}  // namespace nodmap::navigator
