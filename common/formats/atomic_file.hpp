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

/// The same, but throws std::system_error naming the file.
void write_file(const std::filesystem::path& file, std::string_view bytes);

/// The same in two steps, for a file too large for memory. The caller writes the file under its
/// unfinished name, in the same folder, and syncs it to the disk. Then replace_file_by() replaces
/// the old file with it.
[[nodiscard]] std::filesystem::path unfinished_name(const std::filesystem::path& file);
[[nodiscard]] std::error_code replace_file_by(const std::filesystem::path& file,
                                              const std::filesystem::path& unfinished);

/// Waits until the name of a new file is on the disk. It is an entry of the folder, so syncing the
/// file alone does not keep it over a power cut. Some file systems cannot sync a folder: then it
/// does nothing, and that is no error.
[[nodiscard]] std::error_code sync_folder_of(const std::filesystem::path& file);

}  // namespace nodmap::formats
