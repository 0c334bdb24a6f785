// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/data_dir.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

namespace nodmap::test {

std::optional<std::filesystem::path> data_dir() {
  const char* named = std::getenv("NODMAP_DATA");  // NOLINT(concurrency-mt-unsafe)
  const std::filesystem::path dir =
      named != nullptr ? std::filesystem::path(named)
                       : std::filesystem::path(NODMAP_SOURCE_DIR) / ".." / "shared" / "data";
  if (!std::filesystem::is_directory(dir)) {
    return std::nullopt;
  }
  return dir;
}

TemporaryDir::TemporaryDir() {
  std::string name = (std::filesystem::temp_directory_path() / "nodmap-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::system_error(errno, std::system_category(), "cannot make " + name);
  }
  path_ = name;
}

TemporaryDir::~TemporaryDir() {
  std::error_code ignored;  // leaving files in /tmp is no failure
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace nodmap::test
