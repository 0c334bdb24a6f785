// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/quota.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::logger {
namespace quota_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const LogNames kNames = LogNames::dated("lcmlog");

TEST(Quota, NothingIsDeletedWhileEverythingFits) {
  const std::vector<SizedFile> files{{"lcmlog-2026-11-21.00", 60}, {"lcmlog-2026-11-21.01", 40}};
  EXPECT_THAT(files_over_quota(kNames, files, {"lcmlog-2026-11-21.01"}, 100), IsEmpty());
  EXPECT_THAT(files_over_quota(kNames, {}, {}, 0), IsEmpty());
}

TEST(Quota, TheOldestAreDeletedFirstAndNoMoreThanNeeded) {
  const std::vector<SizedFile> files{{"lcmlog-2026-11-21.100", 30},
                                     {"lcmlog-2026-11-21.99", 30},
                                     {"lcmlog-2025-12-31.05", 30},
                                     {"lcmlog-2026-11-21.101", 30}};
  EXPECT_THAT(files_over_quota(kNames, files, {"lcmlog-2026-11-21.101"}, 60),
              ElementsAre("lcmlog-2025-12-31.05", "lcmlog-2026-11-21.99"));
}

TEST(Quota, ForeignFilesAreNeitherCountedNorDeleted) {
  const std::vector<SizedFile> files{{"README.md", 1000},
                                     {"lcmlog-2026-11-21.00.bak", 1000},
                                     {"other-2026-11-21.00", 1000},
                                     {"lcmlog-2026-11-21.00", 10}};
  EXPECT_THAT(files_over_quota(kNames, files, {"lcmlog-2026-11-21.01"}, 100), IsEmpty());
  EXPECT_THAT(files_over_quota(kNames, files, {"lcmlog-2026-11-21.01"}, 5),
              ElementsAre("lcmlog-2026-11-21.00"));
}

TEST(Quota, TheFileBeingWrittenIsNeverDeletedHoweverOldItsName) {
  const std::vector<SizedFile> files{{"lcmlog-2026-11-21.00", 500}, {"lcmlog-2026-11-21.01", 1}};
  EXPECT_THAT(files_over_quota(kNames, files, {"lcmlog-2026-11-21.00"}, 100),
              ElementsAre("lcmlog-2026-11-21.01"));
}

}  // namespace quota_test
}  // namespace nodmap::logger
