// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <optional>

namespace nodmap::test {

/// The folder of the recordings for tests: $NODMAP_DATA, else ../shared/data next to the project;
/// nothing if neither exists. The recordings have their own licences and are not part of the
/// project.
[[nodiscard]] std::optional<std::filesystem::path> data_dir();

/// An empty folder that the destructor removes with its contents.
class TemporaryDir : private boost::noncopyable {
 public:
  TemporaryDir();
  ~TemporaryDir();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace nodmap::test

/// Skips the test if data are missing, with a text that the summary of ./nodmap test repeats.
#define NODMAP_REQUIRE_DATA(variable, relative_path)                                      \
  const auto variable##_root = ::nodmap::test::data_dir();                                \
  if (!variable##_root || !std::filesystem::exists(*variable##_root / (relative_path))) { \
    GTEST_SKIP() << "missing data: " << (relative_path) << " (set NODMAP_DATA)";          \
  }                                                                                       \
  const std::filesystem::path variable = *variable##_root / (relative_path)
