// SPDX-License-Identifier: BSD-3-Clause
// The relations metric of Kuemmerle et al., "On measuring the accuracy of SLAM algorithms", 2009.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::evaluate {

/// The true pose of the robot at `to_stamp` relative to that at `from_stamp`.
struct Relation {
  time::Timestamp from_stamp{};
  time::Timestamp to_stamp{};
  geometry::SE3 T_from_to = geometry::SE3::Identity();
};

/// Reads `t1 t2 x y z roll pitch yaw` lines (s, m, rad). Throws formats::InputFileError with file
/// and line, because an evaluation without a part of the truth would be worthless.
[[nodiscard]] std::vector<Relation> read_relations(const std::filesystem::path& file);

struct RelationErrors {
  std::size_t n = 0;        ///< relations that were measured
  std::size_t missing = 0;  ///< relations with a stamp that the trajectory lacks
  double trans_mean_m = 0.0;
  double trans_std_m = 0.0;  ///< standard deviation of the population, as in the paper's tables
  double trans_max_m = 0.0;
  double rot_mean_rad = 0.0;
  double rot_std_rad = 0.0;
};

/// The error of each relation is the length and the angle of inverse(T_from_to) * (inverse(x_from)
/// * x_to). Stamps are looked up exactly; if a trajectory contains a stamp more than once, its
/// first pose counts. All errors are zero if n is.
[[nodiscard]] RelationErrors measure_relations(const formats::Trajectory& trajectory,
                                               std::span<const Relation> relations);

}  // namespace nodmap::evaluate
