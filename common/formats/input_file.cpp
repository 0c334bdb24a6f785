// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/input_file.hpp"

#include <array>
#include <cerrno>
#include <system_error>

namespace nodmap::formats {
namespace {

constexpr std::size_t kMaxInputBytes = 16'000'000;

}  // namespace

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
  std::string bytes;
  std::array<char, 65536> part{};
  while (in.read(part.data(), part.size()) || in.gcount() > 0) {
    bytes.append(part.data(), static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > kMaxInputBytes) {
      throw InputFileError(file.string() + ": more than 16 MB");
    }
  }
  if (in.bad()) {
    throw std::runtime_error(file.string() + ": cannot read");
  }
  return bytes;
}

}  // namespace nodmap::formats
