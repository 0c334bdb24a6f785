// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "common/formats/cloud_file.hpp"

namespace nodmap::convert {

/// The scans that form the cloud.
struct CloudWindow {
  double start_s = 0.0;  ///< after the first scan of the log
  std::size_t num_scans = 50;
};

/// Forms one cloud of consecutive scans as 6D SLAM does (IV B, Fig. 8): deskewed with ODOMETRY,
/// with points in the base frame at the middle of their time. Writes `out` as PLY or PCD,
/// coloured by height, and a file ending in .tum with the middle time and the odometry pose of
/// base. Scans without odometry are left out, with a warning. Throws formats::UserError if the log
/// has fewer scans, or no odometry in their middle.
void export_cloud(const std::filesystem::path& log, const std::filesystem::path& out,
                  formats::CloudFormat format, const CloudWindow& window);

}  // namespace nodmap::convert
