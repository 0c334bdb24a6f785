// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/failed_places.hpp"

#include <gtest/gtest.h>

namespace nodmap::explorer {
namespace failed_places_test {

const Eigen::Vector2d kPlace(3.0, 1.0);
const Eigen::Vector2d kBeside(3.5, 1.0);
const Eigen::Vector2d kElsewhere(4.0, 1.0);

constexpr time::Timestamp at_s(int seconds) {
  return time::Timestamp(seconds * 1s);
}

TEST(FailedPlaces, APlaceIsLeftOutForATimeThatDoubles) {
  FailedPlaces failures({.retry_s = 30.0, .max_failures = 3});
  failures.add(kPlace, at_s(100));
  EXPECT_TRUE(failures.is_left_out(kBeside, at_s(129)));
  EXPECT_FALSE(failures.is_left_out(kElsewhere, at_s(129)));
  EXPECT_FALSE(failures.is_left_out(kPlace, at_s(130)));
  failures.add(kBeside, at_s(200));
  EXPECT_EQ(failures.size(), 1U) << "it is the same place";
  EXPECT_TRUE(failures.is_left_out(kPlace, at_s(259)));
  EXPECT_FALSE(failures.is_left_out(kPlace, at_s(260)));
  failures.add(kPlace, at_s(300));
  EXPECT_TRUE(failures.is_left_out(kPlace, at_s(1'000'000))) << "given up";
}

TEST(FailedPlaces, WhatIsNotGivenUpIsForgivenOnce) {
  FailedPlaces failures({.retry_s = 30.0, .max_failures = 2});
  EXPECT_FALSE(failures.forgive()) << "there is nothing";
  failures.add(kPlace, at_s(100));
  EXPECT_TRUE(failures.forgive());
  EXPECT_FALSE(failures.is_left_out(kPlace, at_s(101)));
  EXPECT_FALSE(failures.forgive()) << "it is forgiven already";
  failures.add(kPlace, at_s(102));
  EXPECT_FALSE(failures.forgive());
  EXPECT_TRUE(failures.is_left_out(kPlace, at_s(103)));
}

}  // namespace failed_places_test
}  // namespace nodmap::explorer
