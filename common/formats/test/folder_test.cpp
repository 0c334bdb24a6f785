// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/folder.hpp"

#include <gtest/gtest.h>

#include <string>

#include "common/formats/user_error.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace folder_test {

TEST(Folder, IsMadeWithThoseAboveItAndMayExist) {
  const test::TemporaryDir dir;
  const std::filesystem::path folder = dir.path() / "a" / "b";
  EXPECT_TRUE(make_folder(folder));
  EXPECT_TRUE(std::filesystem::is_directory(folder));
  EXPECT_FALSE(make_folder(folder)) << "it was not missing";
}

TEST(Folder, AnErrorNamesItAndTheReason) {
  try {
    make_folder("/dev/null");
    FAIL() << "it is no folder";
  } catch (const UserError& error) {
    EXPECT_EQ(error.what(), std::string("/dev/null: cannot make this folder: Not a directory"));
  }
}

}  // namespace folder_test
}  // namespace nodmap::formats
