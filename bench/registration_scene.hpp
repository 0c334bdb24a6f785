// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "common/geometry/se3.hpp"
#include "sim/world/ray_caster.hpp"

namespace nodmap::bench {

/// A furnished floor of 24 m x 14 m x 2.8 m: a corridor with rooms on both sides, each with tables,
/// cabinets, beams and columns. The same seed gives the same floor.
[[nodiscard]] sim::World furnished_floor(std::uint64_t seed);

/// The shape of a sweep of a nodding scanner: `lines` scan lines of `beams` beams over 180 degrees,
/// evenly spaced in pitch from -50 to 40 degrees.
struct SweepShape {
  int lines = 120;
  int beams = 181;
  double noise_m = 0.01;  ///< standard deviation along the beam
};

/// The points measured by a stationary sensor, in its frame (x forward, z up; m).
[[nodiscard]] std::vector<Eigen::Vector3f> nodding_sweep(const sim::RayCaster& world,
                                                         const geometry::SE3& T_world_sensor,
                                                         const SweepShape& shape,
                                                         std::mt19937_64& random);

/// Poses of the sensor along the corridor and into rooms, each 0.5 m or 22.5 degrees from the last.
[[nodiscard]] std::vector<geometry::SE3> drive_on_floor(std::size_t num_poses,
                                                        std::mt19937_64& random);

/// The pose with independent, normally distributed errors in each direction (standard deviations in
/// m and rad).
[[nodiscard]] geometry::SE3 disturbed(const geometry::SE3& pose, double sigma_m, double sigma_rad,
                                      std::mt19937_64& random);

}  // namespace nodmap::bench
