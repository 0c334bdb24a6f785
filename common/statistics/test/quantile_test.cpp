// SPDX-License-Identifier: BSD-3-Clause
#include "common/statistics/quantile.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::statistics {
namespace quantile_test {

TEST(Quantile, IsTheNearestRank) {
  const std::vector<double> values = {3.0, 1.0, 2.0, 4.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 0.25), 1.0);  // a quarter does not exceed it
  EXPECT_EQ(quantile(values, 0.26), 2.0);
  EXPECT_EQ(quantile(values, 0.5), 2.0);
  EXPECT_EQ(quantile(values, 1.0), 4.0);
}

TEST(Quantile, OfNothingIsZeroAndOfOneValueIsThatValue) {
  EXPECT_EQ(quantile(std::vector<float>{}, 0.5), 0.0F);
  for (const double share : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(quantile(std::vector{7}, share), 7);
  }
}

// The definition itself, counted.
TEST(Quantile, IsTheSmallestValueThatEnoughOthersDoNotExceed) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> digits(0, 9);
  for (std::size_t size = 1; size < 40; ++size) {
    std::vector<int> values(size);
    std::ranges::generate(values, [&] { return digits(random); });
    for (const double share : {0.125, 0.5, 0.75, 1.0}) {  // exact in binary
      const int found = quantile(values, share);
      const auto part_up_to = [&](int value) {
        return static_cast<double>(
                   std::ranges::count_if(values, [value](int v) { return v <= value; })) /
               static_cast<double>(size);
      };
      EXPECT_GE(part_up_to(found), share);
      EXPECT_LT(part_up_to(found - 1), share);
    }
  }
}

}  // namespace quantile_test
}  // namespace nodmap::statistics
