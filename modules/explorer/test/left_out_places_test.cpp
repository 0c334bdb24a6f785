// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/left_out_places.hpp"

#include <gtest/gtest.h>

namespace nodmap::explorer {
namespace left_out_places_test {

const Eigen::Vector2d kPlace(3.0, 1.0);
const Eigen::Vector2d kBeside(3.5, 1.0);
const Eigen::Vector2d kElsewhere(4.0, 1.0);

constexpr time::Timestamp at_s(int seconds) {
  return time::Timestamp(seconds * 1s);
}

TEST(LeftOutPlaces, APlaceIsLeftOutForATimeThatDoubles) {
  LeftOutPlaces places(30.0, 3, 0.7);
  places.add(kPlace, at_s(100));
  EXPECT_TRUE(places.excludes(kBeside, at_s(129)));
  EXPECT_FALSE(places.excludes(kElsewhere, at_s(129)));
  EXPECT_FALSE(places.excludes(kPlace, at_s(130)));
  places.add(kBeside, at_s(200));
  EXPECT_EQ(places.size(), 1U) << "it is the same place";
  EXPECT_TRUE(places.excludes(kPlace, at_s(259)));
  EXPECT_FALSE(places.excludes(kPlace, at_s(260)));
  places.add(kPlace, at_s(300));
  EXPECT_TRUE(places.excludes(kPlace, at_s(1'000'000))) << "given up";
}

TEST(LeftOutPlaces, AClockThatIsSetBackDoesNotProlongThePause) {
  LeftOutPlaces places(30.0, 3, 0.7);
  places.add(kPlace, at_s(10'000));
  EXPECT_FALSE(places.excludes(kPlace, at_s(6'400)));
}

TEST(LeftOutPlaces, PlacesThatAreNotGivenUpAreForgivenOnce) {
  LeftOutPlaces places(30.0, 2, 0.7);
  EXPECT_FALSE(places.permit_retries()) << "there is nothing";
  places.add(kPlace, at_s(100));
  EXPECT_TRUE(places.permit_retries());
  EXPECT_FALSE(places.excludes(kPlace, at_s(101)));
  EXPECT_FALSE(places.permit_retries()) << "it is permitted already";
  places.add(kPlace, at_s(102));
  EXPECT_FALSE(places.permit_retries());
  EXPECT_TRUE(places.excludes(kPlace, at_s(103)));
}

}  // namespace left_out_places_test
}  // namespace nodmap::explorer
