// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <system_error>

namespace nodmap::formats {

/// Replaces a file atomically: at any moment, whatever fails, either the complete old file or the
/// complete new file exists. Writes a temporary file in the same folder, syncs it to the disk and
/// renames it. After an error the old file is unchanged and the temporary one is removed.
[[nodiscard]] std::error_code replace_file(const std::filesystem::path& file,
                                           std::string_view bytes);

}  // namespace nodmap::formats
