// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::convert {

/// Writes the SCANs of a log that are not pitched, and its ODOMETRY, as a CARMEN log. A scan's pose
/// is the odometry at its time. Throws formats::UserError if nothing can be exported.
void export_carmen(const std::filesystem::path& log, const std::filesystem::path& out);

}  // namespace nodmap::convert
