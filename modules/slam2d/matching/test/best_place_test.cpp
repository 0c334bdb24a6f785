// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/best_place.hpp"

#include <gtest/gtest.h>

#include <array>

namespace nodmap::slam2d {
namespace best_place_test {

const Peak kHere{{0.0, 0.0, 0.0}, 0.8};

TEST(BestPlace, ASinglePlaceIsClear) {
  const BestPlace best = best_of(std::array{kHere});
  EXPECT_EQ(best.index, 0U);
  EXPECT_EQ(best.score, 0.8);
  EXPECT_TRUE(best.is_clear(1.5));
}

TEST(BestPlace, PeaksOfTheSamePlaceDoNotCompete) {
  EXPECT_EQ(best_of(std::array{kHere, Peak{{0.4, 0.0, 0.1}, 0.79}}).runner_up_score, 0.0);
  EXPECT_EQ(best_of(std::array{kHere, Peak{{0.6, 0.0, 0.1}, 0.79}}).runner_up_score, 0.79);
  EXPECT_EQ(best_of(std::array{kHere, Peak{{0.4, 0.0, 0.3}, 0.79}}).runner_up_score, 0.79);
}

// The misfit (1 minus the score) is 0.2 at the best place. With a ratio of 1.5 and a margin of
// 0.02, that of another place must be at least 0.32.
TEST(BestPlace, APlaceIsClearIfTheRunnerUpFitsMuchWorse) {
  EXPECT_TRUE(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.67}, kHere}).is_clear(1.5));
  EXPECT_FALSE(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.69}, kHere}).is_clear(1.5));
  EXPECT_TRUE(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.69}, kHere}).is_clear(1.2));
  EXPECT_EQ(best_of(std::array{Peak{{3.0, 0.0, 0.0}, 0.67}, kHere}).index, 1U);
}

}  // namespace best_place_test
}  // namespace nodmap::slam2d
