// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace nodmap::convert {

/// Writes one channel of odometry_t or pose_t as a TUM trajectory. Throws std::runtime_error if it
/// contains none.
void export_tum(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel);

/// Writes one channel as CSV, a row for each message (table_rows.hpp names the types). A row may
/// end with a list, whose length may differ from row to row: a scan's ranges, a map's points.
/// Throws formats::UserError if the channel contains no such messages.
void export_csv(const std::filesystem::path& log, const std::filesystem::path& out,
                const std::string& channel);

}  // namespace nodmap::convert
