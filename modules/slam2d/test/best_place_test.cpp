// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/best_place.hpp"

#include <gtest/gtest.h>

#include <array>

namespace nodmap::slam2d {
namespace best_place_test {

const Peak kHere{{0.0, 0.0, 0.0}, 0.8};

TEST(BestPlace, APlaceAloneIsClear) {
  const BestPlace best = best_of(std::array{kHere});
  EXPECT_EQ(best.index, 0U);
  EXPECT_EQ(best.score, 0.8);
  EXPECT_TRUE(best.is_clear(1.5));
}

TEST(BestPlace, ThoseThatAreTheSamePlaceDoNotCompete) {
  EXPECT_EQ(best_of(std::array{kHere, Peak{{0.4, 0.0, 0.1}, 0.79}}).runner_up_score, 0.0);
  EXPECT_EQ(best_of(std::array{kHere, Peak{{0.6, 0.0, 0.1}, 0.79}}).runner_up_score, 0.79);
  EXPECT_EQ(best_of(std::array{kHere, Peak{{0.4, 0.0, 0.3}, 0.79}}).runner_up_score, 0.79);
}

// At the best place the misfit is 0.2; 1.5 times as much is 0.3, and the margin is 0.02.
TEST(BestPlace, AnotherMustFitClearlyLess) {
  EXPECT_TRUE(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.67}, kHere}).is_clear(1.5));
  EXPECT_FALSE(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.69}, kHere}).is_clear(1.5));
  EXPECT_TRUE(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.69}, kHere}).is_clear(1.2));
  EXPECT_EQ(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.67}, kHere}).index, 1U);
}

}  // namespace best_place_test
}  // namespace nodmap::slam2d
