// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::convert {

/// Writes each keyframe of a saved 3D map (keyframes.lcmlog, or the folder with it) as a scan of
/// 3DTK: scanNNN.3d with the points of base and scanNNN.pose with its corrected pose in map.
/// `out` is a folder that does not exist yet; it is made only when it is complete. Throws
/// formats::UserError if there is no keyframe.
void export_uos(const std::filesystem::path& map, const std::filesystem::path& out);

}  // namespace nodmap::convert
