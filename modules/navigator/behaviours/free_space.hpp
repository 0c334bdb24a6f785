// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/behaviours/side.hpp"

namespace nodmap::navigator {

/// How far the robot could drive straight in each direction ahead: one value for each degree from
/// -90 to 90.
struct FreeSpace {
  static constexpr int kHalf = 90;

  /// Free distance from the robot's front, metres; +infinity: nothing there. Entry kHalf is ahead.
  std::array<double, 2 * kHalf + 1> distance_m{};

  /// The direction of an entry: -90..90 to radians, positive left.
  [[nodiscard]] static double angle_rad(int degree);
  [[nodiscard]] static int degree_of(double angle_rad);
  [[nodiscard]] static std::size_t index(int degree) {
    const int entry = degree + kHalf;
    return static_cast<std::size_t>(entry);
  }
  [[nodiscard]] double at(int degree) const { return distance_m[index(degree)]; }
  [[nodiscard]] double& at(int degree) { return distance_m[index(degree)]; }
};

/// Measures the free distance in each direction, in a corridor as wide as the body and a margin on
/// both sides: a gap narrower than the robot is not free.
[[nodiscard]] FreeSpace measure_free_space(const Points& points_base, const robot::Footprint& body,
                                           double side_margin_m);

/// Steer: the orientation of free space (Lingemann et al. 2005, used by the paper, III C),
///
///     alpha = atan2(sum sin(phi) f(phi) g(d), sum cos(phi) f(phi) g(d))
///
/// f(phi) = cos(1.2 (phi - wanted)), 0 where negative, prefers the wanted direction (ahead, or that
/// of the goal); g(d) = 1 / (1 + exp(-(d - open_space) / 0.25 m)) is a soft threshold. Empty if
/// nothing is free. Mirrored input gives exactly mirrored output, because the terms of +phi and
/// -phi are added in pairs.
[[nodiscard]] std::optional<double> free_space_orientation(const FreeSpace& space,
                                                           double wanted_rad, double open_space_m);

/// The free directions nearest to alpha on its left and on its right; both are alpha if that is
/// free. Needed because the orientation is a mean: between two doors it points at the wall.
struct FreeNeighbours {
  std::optional<double> left_rad;
  std::optional<double> right_rad;
};
[[nodiscard]] FreeNeighbours free_neighbours(const FreeSpace& space, double alpha_rad,
                                             double needed_m);

/// The side with more room; none if both have the same. Distances count up to 3 m.
[[nodiscard]] Side side_with_more_room(const FreeSpace& space);

}  // namespace nodmap::navigator
