// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace nodmap::convert {

/// Writes one channel of odometry_t or pose_t as a TUM trajectory. Throws std::runtime_error when
/// it holds none.
void export_tum(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel);

/// Writes one channel as CSV, a row for each message (table_rows.hpp names the types). A row may
/// end with a list, of which there may be more in one row than in another: a scan's ranges, a map's
/// points. Throws std::runtime_error when the channel holds nothing that makes a row.
void export_csv(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel);

}  // namespace nodmap::convert
