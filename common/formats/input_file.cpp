// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/input_file.hpp"

#include <cerrno>
#include <iterator>
#include <system_error>

namespace nodmap::formats {

InputFileError cannot_open(const std::filesystem::path& file, int error) {
  InputFileError exception(file.string() +
                           ": cannot open: " + std::system_category().message(error));
  return exception;
}

std::ifstream open_input(const std::filesystem::path& file) {
  std::error_code unknown;  // opening the file will report it
  if (std::filesystem::is_directory(file, unknown)) {
    throw cannot_open(file, EISDIR);  // a folder can be opened, but not read
  }
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw cannot_open(file, errno);
  }
  return in;
}

std::string read_input(const std::filesystem::path& file) {
  std::ifstream in = open_input(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace nodmap::formats
