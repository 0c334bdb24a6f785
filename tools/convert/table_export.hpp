// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace nodmap::convert {

/// Writes one channel of odometry_t or pose_t as a TUM trajectory. Throws std::runtime_error when
/// it holds none.
void export_tum(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel);

/// Writes one channel of scan_t, odometry_t or pose_t as CSV, a row for each message. A scan's row
/// ends with its ranges (m), of which there may be more in one row than in another. Throws
/// std::runtime_error when the channel holds none.
void export_csv(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel);

}  // namespace nodmap::convert
