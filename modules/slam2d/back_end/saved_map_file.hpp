// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <system_error>

#include "modules/slam2d/back_end/saved_map.hpp"

namespace nodmap::slam2d {

/// Writes keyframes.lcmlog into a folder: an LCM event log with a keyframe_2d_t for each keyframe,
/// a loop_2d_t for each pair of submaps that a loop joins, a loop_statistics_2d_t, and a
/// cleared_region_2d_t for each cleared region. An existing file stays in place until the new one
/// is complete and on the disk.
[[nodiscard]] std::error_code write_saved_map(const std::filesystem::path& dir,
                                              const SavedMap& map);

/// Reads a saved map. `path` is a keyframes.lcmlog, or a folder with one. Throws
/// formats::InputFileError, which names the file and what is wrong with it: it cannot be read, is
/// damaged or truncated, or has no keyframes.
[[nodiscard]] SavedMap read_saved_map(const std::filesystem::path& path);

}  // namespace nodmap::slam2d
