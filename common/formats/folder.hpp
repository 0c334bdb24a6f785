// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace nodmap::formats {

/// Makes a folder that the user has named, and those above it. Returns whether it was missing.
/// Throws UserError, naming the folder and the reason, if it cannot be made.
bool make_folder(const std::filesystem::path& dir);

}  // namespace nodmap::formats
