// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

namespace nodmap::convert {

/// Which scans make the cloud.
struct CloudWindow {
  double start_s = 0.0;  ///< after the first scan of the log
  std::size_t num_scans = 50;
};

/// Makes one cloud of consecutive scans as 6D SLAM does (IV B, Fig. 8): the motion between the
/// beams is taken out by ODOMETRY, points are given in the base frame in the middle of their time.
/// Writes `out` as PLY, coloured by height, and beside it, ending in .tum, that time with the base
/// pose by odometry. Throws std::runtime_error when the log has fewer scans or no odometry there.
void export_cloud(const std::filesystem::path& log, const std::filesystem::path& out,
                  const CloudWindow& window);

}  // namespace nodmap::convert
