// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::convert {

/// Writes what nodmap-viewer shows of a log, every message of it, as MCAP. Throws
/// std::runtime_error when it holds no event, or none of ours.
void export_mcap(const std::filesystem::path& log, const std::filesystem::path& out);

}  // namespace nodmap::convert
