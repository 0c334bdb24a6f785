// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <system_error>

#include "modules/slam6d/back_end/saved_map.hpp"

namespace nodmap::slam6d {

/// Writes keyframes.lcmlog into a folder: an LCM event log with a keyframe_6d_t for each keyframe
/// and a loop_6d_t for each loop. An existing file stays in place until the new one is complete and
/// on the disk.
[[nodiscard]] std::error_code write_saved_map(const std::filesystem::path& dir,
                                              const SavedMap& map);

/// Reads a saved map. `path` is a keyframes.lcmlog, or a folder with one. Throws
/// formats::InputFileError, naming the file and what is wrong, also if the file is damaged,
/// truncated or has no keyframes.
[[nodiscard]] SavedMap read_saved_map(const std::filesystem::path& path);

}  // namespace nodmap::slam6d
