// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/command_line.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "tests/support/data_dir.hpp"

namespace nodmap::node {
namespace {

TEST(ResultDir, IsMadeAndNeverOverwritten) {
  const test::TemporaryDir dir;
  make_result_dir(dir.path() / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(dir.path() / "a" / "b"));
  EXPECT_NO_THROW(make_result_dir(dir.path() / "a" / "b"));  // exists, but empty
  std::ofstream(dir.path() / "a" / "b" / "result.json") << "{}";
  EXPECT_THROW(make_result_dir(dir.path() / "a" / "b"), std::runtime_error);
}

}  // namespace
}  // namespace nodmap::node
