// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "common/formats/user_error.hpp"

namespace nodmap::formats {

/// Thrown when a file named by the user cannot be used, with a message such as "FILE: cannot open:
/// REASON".
class InputFileError : public UserError {
 public:
  using UserError::UserError;
};

/// The exception for a file that the operating system could not open; `error` is the value of
/// errno.
[[nodiscard]] InputFileError cannot_open(const std::filesystem::path& file, int error);

/// Opens a file to read its bytes. Throws InputFileError, also for a folder.
[[nodiscard]] std::ifstream open_input(const std::filesystem::path& file);

/// The bytes of a file that people write, such as a configuration. Throws as open_input(), also for
/// more than 16 MB.
[[nodiscard]] std::string read_input(const std::filesystem::path& file);

}  // namespace nodmap::formats
