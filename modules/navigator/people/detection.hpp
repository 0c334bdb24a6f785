// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace nodmap::navigator {

/// Something compact in a scan.
struct Detection {
  Eigen::Vector2d p_odom = Eigen::Vector2d::Zero();  ///< centre of a disc with this radius
  double radius_m = 0.0;
  double lowest_m = 0.0;  ///< height of the lowest and the highest hit above the floor
  double highest_m = 0.0;
  double free_ratio = 1.0;  ///< the fraction of its hits in ever-free space
  int num_legs = 0;         ///< 1: as narrow as a leg; 2: a pair of these; 0: wider
  std::size_t num_beams = 0;
};

}  // namespace nodmap::navigator
