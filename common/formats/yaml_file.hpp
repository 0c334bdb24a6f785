// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace YAML {  // NOLINT(readability-identifier-naming): yaml-cpp's name
class Node;
}

namespace nodmap::formats {

/// The only document of a YAML file; null if the file is empty. Throws InputFileError, with a
/// message such as "FILE:LINE: REASON", if the file cannot be read, is not YAML or has a second
/// document.
[[nodiscard]] YAML::Node read_yaml(const std::filesystem::path& file);

}  // namespace nodmap::formats
