// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::formats {

struct StampedPose {
  time::Timestamp stamp{};
  geometry::SE3 pose = geometry::SE3::Identity();
};

using Trajectory = std::vector<StampedPose>;

/// Writes `timestamp x y z qx qy qz qw` lines: seconds with six decimals, metres. Replaces
/// the file only when all of them are on the disk. Throws std::runtime_error naming it.
void write_tum(const std::filesystem::path& file, const Trajectory& trajectory);

/// Reads such lines; `#` comments and empty lines are skipped, stamps kept to the microsecond.
/// Throws InputFileError naming file and line.
[[nodiscard]] Trajectory read_tum(const std::filesystem::path& file);

}  // namespace nodmap::formats
