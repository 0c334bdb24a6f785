// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::convert {

/// Converts a line-by-line nodding recording to an LCM event log: each line becomes a pitched SCAN
/// after an ODOMETRY of a stationary robot. Lines without a stamp follow each other at the rate of
/// the scanner, from a fixed epoch. Throws formats::UserError if nothing can be converted.
void import_nod(const std::filesystem::path& in, const std::filesystem::path& out);

}  // namespace nodmap::convert
