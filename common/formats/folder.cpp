// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/folder.hpp"

#include <system_error>

#include "common/formats/user_error.hpp"

namespace nodmap::formats {

bool make_folder(const std::filesystem::path& dir) {
  std::error_code error;
  const bool was_missing = std::filesystem::create_directories(dir, error);
  if (error) {
    throw UserError(dir.string() + ": cannot make this folder: " + error.message());
  }
  return was_missing;
}

}  // namespace nodmap::formats
