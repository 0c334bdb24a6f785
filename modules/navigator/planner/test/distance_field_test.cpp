// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/distance_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace nodmap::navigator {
namespace distance_field_test {

// Oracle: the smallest distance to any occupied cell, by brute force.
TEST(DistanceField, EqualsTheDistanceToTheNearestOccupiedCell) {
  constexpr int kWidth = 37;
  constexpr int kHeight = 23;
  constexpr double kCellM = 0.05;
  std::mt19937 random(3);
  std::uniform_int_distribution<int> column(0, kWidth - 1);
  std::uniform_int_distribution<int> row(0, kHeight - 1);
  for (int num_occupied : {1, 2, 7, 60}) {
    DistanceField field;
    field.begin({-1.0, 2.0}, kCellM, kWidth, kHeight);
    std::vector<Eigen::Vector2i> occupied;
    for (int i = 0; i < num_occupied; ++i) {
      occupied.emplace_back(column(random), row(random));
      field.occupy(occupied.back().x(), occupied.back().y());
    }
    field.compute();
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        double nearest = 1e9;
        for (const Eigen::Vector2i& cell : occupied) {
          nearest = std::min(nearest, (cell - Eigen::Vector2i(x, y)).cast<double>().norm());
        }
        // The field is in single precision.
        EXPECT_NEAR(field.at(x, y), kCellM * nearest, 1e-6);
      }
    }
  }
}

TEST(DistanceField, TheDistanceIsGreatWithoutOccupiedCellsAndOutsideTheField) {
  DistanceField field;
  field.begin({0.0, 0.0}, 0.1, 10, 10);
  field.occupy({-5.0, 3.0});
  field.compute();
  EXPECT_EQ(field.at(Eigen::Vector2d(0.5, 0.5)), DistanceField::kFarM);
  field.occupy({0.5, 0.5});
  field.compute();
  EXPECT_EQ(field.at(Eigen::Vector2d(-0.5, 0.5)), DistanceField::kFarM);
  EXPECT_EQ(field.at(Eigen::Vector2d(0.55, 0.55)), 0.0);
}

}  // namespace distance_field_test
}  // namespace nodmap::navigator
