// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/rotation.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace nodmap::logger {
namespace rotation_test {

constexpr time::Duration kDay = 24h;
constexpr time::Timestamp kNoon(1'795'262'400s);  // 2026-11-21 12:00:00 UTC, by date(1)

TEST(Rotation, DatesAreThoseOfUtc) {
  EXPECT_EQ(utc_date(kNoon), "2026-11-21");
  EXPECT_EQ(utc_date(kNoon + kDay / 2 - 1us), "2026-11-21");
  EXPECT_EQ(utc_date(kNoon + kDay / 2), "2026-11-22");
  EXPECT_EQ(utc_date({}), "1970-01-01");
  EXPECT_EQ(utc_date(time::Timestamp(-1us)), "1969-12-31");
}

TEST(Rotation, TheFirstNamesOfADay) {
  const LogNames names = LogNames::dated("lcmlog");
  EXPECT_EQ(names.next(kNoon, {}), "lcmlog-2026-11-21.00");
  const std::vector<std::string> existing{"lcmlog-2026-11-21.00", "notes.txt"};
  EXPECT_EQ(names.next(kNoon, existing), "lcmlog-2026-11-21.01");
  EXPECT_EQ(names.next(kNoon + kDay, existing), "lcmlog-2026-11-22.00");
}

TEST(Rotation, TheNameOfADeletedFileIsNotUsedAgain) {
  const std::vector<std::string> existing{"lcmlog-2026-11-21.07", "lcmlog-2026-11-21.03"};
  EXPECT_EQ(LogNames::dated("lcmlog").next(kNoon, existing), "lcmlog-2026-11-21.08");
}

TEST(Rotation, NumbersGoBeyondTwoDigits) {
  const std::vector<std::string> existing{"lcmlog-2026-11-21.99"};
  const LogNames names = LogNames::dated("lcmlog");
  const std::string next = names.next(kNoon, existing);
  EXPECT_EQ(next, "lcmlog-2026-11-21.100");
  EXPECT_GT(names.order_of(next), names.order_of(existing[0]));
}

TEST(Rotation, AfterAClockIsSetBackNamesStillAscend) {
  const std::vector<std::string> existing{"lcmlog-2026-11-21.02"};
  EXPECT_EQ(LogNames::dated("lcmlog").next({}, existing), "lcmlog-2026-11-21.03");
}

TEST(Rotation, AGivenNameIsUsedForTheFirstFile) {
  const LogNames names = LogNames::fixed("run.lcmlog");
  std::vector<std::string> existing;
  for (const char* expected : {"run.lcmlog", "run.lcmlog.01", "run.lcmlog.02"}) {
    existing.push_back(names.next(kNoon, existing));
    EXPECT_EQ(existing.back(), expected);
  }
}

// Every name accepted here may be deleted for the quota.
TEST(Rotation, OnlyNamesThatCouldBeOursAreOurs) {
  const LogNames dated = LogNames::dated("lcmlog");
  EXPECT_TRUE(dated.order_of("lcmlog-2026-11-21.00"));
  EXPECT_TRUE(dated.order_of("lcmlog-2026-11-21.1234"));
  for (const char* foreign :
       {"", "lcmlog", "lcmlog-2026-11-21", "lcmlog-2026-11-21.", "lcmlog-2026-11-21.0",
        "lcmlog-2026-11-21.001", "lcmlog-2026-11-21.00.gz", "lcmlog-2026-11-21.00~",
        "lcmlog-2026-11-2x.00", "lcmlog-2026_11-21.00", "xlcmlog-2026-11-21.00",
        "lcmlog2026-11-21.00", "lcmlog-2026-11-21.-1", "lcmlog-2026-11-21.2147483647",
        "lcmlog-2026-11-21.99999999999"}) {
    EXPECT_FALSE(dated.order_of(foreign)) << foreign;
  }
  const LogNames fixed = LogNames::fixed("run");
  EXPECT_TRUE(fixed.order_of("run"));
  EXPECT_TRUE(fixed.order_of("run.01"));
  for (const char* foreign : {"run.00", "run.1", "run.txt", "run01", "runs", "ru"}) {
    EXPECT_FALSE(fixed.order_of(foreign)) << foreign;
  }
}

TEST(Rotation, SplitsBeforeTheEventThatWouldNotFit) {
  EXPECT_FALSE(must_split(900, 100, 1000));
  EXPECT_TRUE(must_split(901, 100, 1000));
  EXPECT_FALSE(must_split(0, 5000, 1000)) << "an event too large for any file gets its own";
  EXPECT_TRUE(must_split(1, 5000, 1000));
  EXPECT_FALSE(must_split(1'000'000, 5000, 0));
}

}  // namespace rotation_test
}  // namespace nodmap::logger
