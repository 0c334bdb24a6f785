// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <system_error>

namespace nodmap::formats {

/// Writes a file so that at any moment, whatever fails, there is the old one or the new one, whole:
/// written under a temporary name beside it, brought to the disk, renamed. An error leaves the old
/// file as it was and no temporary one.
[[nodiscard]] std::error_code replace_file(const std::filesystem::path& file,
                                           std::string_view bytes);

}  // namespace nodmap::formats
