// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::foxglove::test {

struct RobotLog {
  double duration_s = 10.0;
  int points_per_keyframe = 12'000;
  double keyframe_every_s = 1.0;
};

/// Writes all channels at their usual rates.
void write_robot_log(const std::filesystem::path& file, const RobotLog& settings);

}  // namespace nodmap::foxglove::test
