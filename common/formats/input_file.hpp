// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace nodmap::formats {

/// A file that was named cannot be used at all: "FILE: cannot open: REASON", for one. A program
/// ends with 2 for it, as for any other wrong command line.
class InputFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What to throw for a file that the operating system does not open, for `error` of errno.
[[nodiscard]] InputFileError cannot_open(const std::filesystem::path& file, int error);

/// Opens a file to read its bytes. Throws InputFileError, also for a folder.
[[nodiscard]] std::ifstream open_input(const std::filesystem::path& file);

/// The bytes of a file. Throws as open_input().
[[nodiscard]] std::string read_input(const std::filesystem::path& file);

}  // namespace nodmap::formats
