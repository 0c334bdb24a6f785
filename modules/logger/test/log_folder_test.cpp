// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/log_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <utility>

#include "modules/logger/test/names_in.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::logger {
namespace log_folder_test {

using ::testing::ElementsAre;

class LogFolderTest : public ::testing::Test {
 protected:
  void add(const std::string& name, std::size_t size_bytes) {
    std::ofstream(dir_.path() / name) << std::string(size_bytes, 'x');
  }

  [[nodiscard]] LogFolder folder(std::int64_t quota_bytes) const {
    return LogFolder({.dir = dir_.path(), .quota_bytes = quota_bytes});
  }

  [[nodiscard]] std::vector<std::string> names() const {
    return names_in_folder::names_in(dir_.path());
  }

  test::TemporaryDir dir_;
};

TEST_F(LogFolderTest, NothingIsDeletedWhileEverythingFits) {
  add("lcmlog-2026-11-21.00", 60);
  add("lcmlog-2026-11-21.01", 40);
  LogFolder dut = folder(100);
  dut.delete_oldest({"lcmlog-2026-11-21.01", 40});
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.00", "lcmlog-2026-11-21.01"));
  EXPECT_EQ(dut.num_deleted(), 0);
}

TEST_F(LogFolderTest, TheOldestAreDeletedFirstAndNoMoreThanNeeded) {
  add("lcmlog-2026-11-21.100", 30);
  add("lcmlog-2026-11-21.99", 30);
  add("lcmlog-2025-12-31.05", 30);
  add("lcmlog-2026-11-21.101", 30);
  LogFolder dut = folder(60);
  dut.delete_oldest({"lcmlog-2026-11-21.101", 30});
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.100", "lcmlog-2026-11-21.101"));
  EXPECT_EQ(dut.num_deleted(), 2);
}

TEST_F(LogFolderTest, ForeignFilesAreNeitherCountedNorDeleted) {
  add("README.md", 1000);
  add("lcmlog-2026-11-21.00.bak", 1000);
  add("other-2026-11-21.00", 1000);
  add("lcmlog-2026-11-21.00", 10);
  std::filesystem::create_symlink("README.md", dir_.path() / "lcmlog-2020-01-01.00");
  std::filesystem::create_directory(dir_.path() / "lcmlog-2020-01-01.01");
  LogFolder ample = folder(100);
  ample.delete_oldest({"lcmlog-2026-11-21.01", 1});
  EXPECT_EQ(names().size(), 6U);
  LogFolder tight = folder(5);
  tight.delete_oldest({"lcmlog-2026-11-21.01", 1});
  EXPECT_EQ(names().size(), 5U);
  EXPECT_FALSE(std::filesystem::exists(dir_.path() / "lcmlog-2026-11-21.00"));
}

TEST_F(LogFolderTest, TheCurrentLogIsNeverDeletedHoweverOldItsName) {
  add("lcmlog-2026-11-21.00", 500);
  add("lcmlog-2026-11-21.01", 1);
  LogFolder dut = folder(100);
  dut.delete_oldest({"lcmlog-2026-11-21.00", 500});
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.00"));
}

TEST_F(LogFolderTest, TheLastRecordingStaysUntilTheCurrentLogHasEvents) {
  add("lcmlog-2026-11-21.00", 500);
  add("lcmlog-2026-11-21.01", 500);
  add("lcmlog-2026-11-21.02", 0);
  LogFolder dut = folder(100);
  dut.delete_oldest({"lcmlog-2026-11-21.02", 0});
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.01", "lcmlog-2026-11-21.02"));
  dut.keep_quota({"lcmlog-2026-11-21.02", 1});
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.02"));
}

// No permission keeps root from deleting, so the log becomes a folder with content in the moment
// between the look into the folder and the deletion.
TEST_F(LogFolderTest, ALogThatCannotBeDeletedIsTriedAgainOnlyWithTheNextLog) {
  int num_looks = 0;
  const auto available = [&](const std::filesystem::path& dir) {
    if (++num_looks == 1) {
      std::filesystem::remove(dir / "lcmlog-2026-11-21.00");
      std::filesystem::create_directories(dir / "lcmlog-2026-11-21.00" / "content");
    }
    return std::int64_t{10};
  };
  add("lcmlog-2026-11-21.00", 500);
  add("lcmlog-2026-11-21.01", 20);
  LogFolder dut(
      {.dir = dir_.path(), .quota_bytes = 10, .reserve_bytes = 1, .available_bytes = available});
  dut.delete_oldest({"lcmlog-2026-11-21.02", 1});
  EXPECT_EQ(dut.num_deleted(), 1) << "the other one";
  EXPECT_EQ(num_looks, 1);
  add("lcmlog-2026-11-21.01", 20);
  dut.keep_quota({"lcmlog-2026-11-21.02", 500});
  EXPECT_EQ(num_looks, 1) << "nothing was tried";
  dut.delete_oldest({"lcmlog-2026-11-21.03", 1});
  EXPECT_EQ(dut.num_deleted(), 2);
}

TEST_F(LogFolderTest, InPlaceOfALogThatCannotBeDeletedTheNextOldestAreDeleted) {
  bool is_first_look = true;
  const auto available = [&](const std::filesystem::path& dir) {
    if (std::exchange(is_first_look, false)) {
      std::filesystem::remove(dir / "lcmlog-2026-11-21.00");
      std::filesystem::create_directories(dir / "lcmlog-2026-11-21.00" / "content");
    }
    return std::int64_t{70};  // 30 of the reserve are missing
  };
  add("lcmlog-2026-11-21.00", 500);
  add("lcmlog-2026-11-21.01", 20);
  add("lcmlog-2026-11-21.02", 20);
  add("lcmlog-2026-11-21.03", 20);
  LogFolder dut({.dir = dir_.path(), .reserve_bytes = 100, .available_bytes = available});
  dut.delete_oldest({"lcmlog-2026-11-21.04", 1});
  EXPECT_THAT(names(), ElementsAre("lcmlog-2026-11-21.00", "lcmlog-2026-11-21.03"));
}

TEST_F(LogFolderTest, AMissingFolderHasTheSpaceOfTheDiskOnWhichItWouldBe) {
  const std::int64_t on_this_disk = free_bytes(dir_.path());
  EXPECT_LT(free_bytes(dir_.path() / "no" / "such"), 2 * on_this_disk);
  EXPECT_LT(free_bytes("no_such_folder"), std::numeric_limits<std::int64_t>::max());
}

}  // namespace log_folder_test
}  // namespace nodmap::logger
