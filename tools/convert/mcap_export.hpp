// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::convert {

/// Writes everything that nodmap-viewer shows of a log as MCAP. Throws formats::UserError if the
/// log contains no event, or none of ours.
void export_mcap(const std::filesystem::path& log, const std::filesystem::path& out);

}  // namespace nodmap::convert
