// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/deputy_reports.hpp"

#include <gtest/gtest.h>

#include <cstddef>

namespace nodmap::procman {
namespace deputy_reports_test {

DeputyInfo info_of(const std::string& deputy) {
  DeputyInfo info;
  info.deputy_id = deputy;
  return info;
}

// Anybody can report in any number of names.
TEST(DeputyReports, InventedNamesLeaveRoomForAnExpectedDeputy) {
  DeputyReports reports;
  reports.expect("robot");
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) {
    taken += reports.take(info_of("invented" + std::to_string(i)), {}, {}) ? 1 : 0;
  }
  EXPECT_LT(taken, 1000U);
  EXPECT_EQ(reports.all().size(), taken + 1U);
  EXPECT_EQ(reports.find("robot"), nullptr);
  EXPECT_TRUE(reports.take(info_of("robot"), {}, {}));
  EXPECT_NE(reports.find("robot"), nullptr);
}

TEST(DeputyReports, AGapBeginsWhereAnInfoIsMissing) {
  DeputyReports reports;
  const auto reporting_since = [&reports](time::Duration now) {
    EXPECT_TRUE(reports.take(info_of("robot"), time::SteadyTime(now), {}));
    return reports.find("robot")->reporting_since.time_since_epoch();
  };
  EXPECT_EQ(reporting_since(1s), 1s);
  EXPECT_EQ(reporting_since(2s), 1s);
  EXPECT_EQ(reporting_since(2s + DeputyReports::kInfoGap), 1s);
  EXPECT_EQ(reporting_since(2s + 2 * DeputyReports::kInfoGap + 1us),
            2s + 2 * DeputyReports::kInfoGap + 1us);
}

}  // namespace deputy_reports_test
}  // namespace nodmap::procman
