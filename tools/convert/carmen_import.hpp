// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::convert {

/// Converts a CARMEN log to an LCM event log: scans to SCAN with pitch 0, each after an ODOMETRY
/// with the robot pose in its line; ODOM lines to ODOMETRY. Stamps are the ipc_timestamps,
/// unchanged. Throws formats::UserError if nothing can be converted.
void import_carmen(const std::filesystem::path& in, const std::filesystem::path& out);

}  // namespace nodmap::convert
