// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <limits>

namespace nodmap::convert {

/// The numbers of the scans to convert, from `first` to `last`, both included.
struct UosRange {
  int first = 0;
  int last = std::numeric_limits<int>::max();
};

/// Converts 3DTK's stop-and-go scans (scanNNN.3d, scanNNN.pose) to an LCM event log: each slice
/// becomes a pitched SCAN after an ODOMETRY with the scan's pose, at the rate of the scanner;
/// between two scans there is a drive with ODOMETRY at 100 Hz. The files contain no times, so the
/// log starts at a fixed epoch. Throws formats::UserError if nothing can be converted.
void import_uos(const std::filesystem::path& dir, const std::filesystem::path& out,
                const UosRange& range);

}  // namespace nodmap::convert
