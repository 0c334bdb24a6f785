// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/atomic_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "common/formats/file_replacement.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::formats {
namespace atomic_file_test {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t files_in(const fs::path& dir) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(dir), fs::directory_iterator()));
}

TEST(AtomicFile, R46_ReplacesWholeFiles) {
  const test::TemporaryDir dir;
  const fs::path file = dir.path() / "map.bt";
  EXPECT_FALSE(replace_file(file, "old and longer"));
  EXPECT_EQ(read(file), "old and longer");
  EXPECT_FALSE(replace_file(file, std::string("new\0bytes", 9)));
  EXPECT_EQ(read(file), std::string("new\0bytes", 9));
  EXPECT_FALSE(replace_file(file, ""));
  EXPECT_EQ(read(file), "");
  EXPECT_EQ(files_in(dir.path()), 1U);  // no temporary file is left
}

// /dev/full takes no byte: a disk that is full while the new file is written. The temporary name
// leads there.
TEST(AtomicFile, R46_AFullDiskKeepsTheOldFile) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "no /dev/full on this system";
  }
  const test::TemporaryDir dir;
  const fs::path file = dir.path() / "map.bt";
  ASSERT_FALSE(replace_file(file, "old"));
  fs::create_symlink("/dev/full", dir.path() / "map.bt.part");
  EXPECT_EQ(replace_file(file, "new"), std::errc::no_space_on_device);
  EXPECT_EQ(read(file), "old");
  EXPECT_EQ(files_in(dir.path()), 1U);
}

TEST(AtomicFile, R46_AFailingFolderKeepsTheOldFile) {
  const test::TemporaryDir dir;
  EXPECT_TRUE(replace_file(dir.path() / "missing" / "map.bt", "new"));
  EXPECT_EQ(files_in(dir.path()), 0U);
  // The name is a folder that holds something: the rename fails, after all was written.
  fs::create_directories(dir.path() / "map.bt" / "old");
  EXPECT_TRUE(replace_file(dir.path() / "map.bt", "new"));
  EXPECT_TRUE(fs::is_directory(dir.path() / "map.bt" / "old"));
  EXPECT_EQ(files_in(dir.path()), 1U);
}

TEST(FileReplacement, ReplacesTheFileWhenAllPartsAreWritten) {
  const test::TemporaryDir dir;
  const fs::path file = dir.path() / "cloud.ply";
  ASSERT_FALSE(replace_file(file, "old"));
  {
    FileReplacement given_up(file);
    given_up.write("new");
  }
  EXPECT_EQ(read(file), "old");
  FileReplacement replacement(file);
  replacement.write("new ");
  replacement.write("and in parts");
  EXPECT_EQ(read(file), "old");
  EXPECT_FALSE(replacement.replace());
  EXPECT_EQ(read(file), "new and in parts");
  EXPECT_EQ(files_in(dir.path()), 1U);
}

// /proc is a file system that cannot sync a folder.
TEST(AtomicFile, R46_AFolderThatCannotBeSyncedIsNoError) {
  if (!fs::exists("/proc/self")) {
    GTEST_SKIP() << "no /proc on this system";
  }
  EXPECT_FALSE(sync_folder_of("/proc/map.bt"));
  EXPECT_EQ(sync_folder_of("/proc/missing/map.bt"), std::errc::no_such_file_or_directory);
}

}  // namespace atomic_file_test
}  // namespace nodmap::formats
