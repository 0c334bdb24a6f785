// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/results.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/logged.hpp"

namespace nodmap::slam2d {
namespace results_test {

TEST(Results, ImagesOfEmptyInputAndOfAPathAreDrawn) {
  EXPECT_GT(draw_paths({}, {}).width(), 0);
  EXPECT_GT(draw_map(OccupancyGrid(0.05), {}).width(), 0);
  const std::vector<geometry::SE2> path{{0, 0, 0}, {10, 0, 0}};
  const drawing::Image image = draw_paths(path, {});
  // The image shows the 10 m of the path and a border of 1 m on either side; the path runs through
  // its middle.
  EXPECT_NE(image.at(image.width() / 2, image.height() / 2), drawing::kWhite);
  EXPECT_EQ(image.at(image.width() / 2, 2), drawing::kWhite);
}

TEST(Results, ASmallMapIsEnlargedAndALargeOneKeepsAllCells) {
  OccupancyGrid coarse(0.5);
  ASSERT_TRUE(coarse.add_ray({0.25, 0.25}, {0.25, 1.25}));
  const drawing::Image small = draw_map(coarse, {});
  EXPECT_EQ(std::max(small.width(), small.height()), 1200);
  OccupancyGrid fine(0.05);
  ASSERT_TRUE(fine.add_ray({0.0, 0.0}, {0.0, 1.0}));
  const drawing::Image large = draw_map(fine, {});
  EXPECT_GE(large.width(), fine.width());
}

TEST(Results, TheStartAndOdometryAreDrawn) {
  const std::vector<geometry::SE2> path{{0, 0, 0}, {10, 0, 0}};
  const std::vector<geometry::SE2> odometry{{0, 0, 0}, {10, 1, 0}};
  const drawing::Image one = draw_paths(path, {});
  const drawing::Image marked = draw_paths(path, odometry);
  // The disc at the start of the path is wider than the line, which is two pixels wide.
  EXPECT_NE(one.at(100, one.height() / 2 - 4), drawing::kWhite);
  EXPECT_EQ(one.at(400, one.height() / 2 - 4), drawing::kWhite);
  int grey = 0;
  for (int x = 0; x < marked.width(); ++x) {
    for (int y = 0; y < marked.height(); ++y) {
      grey += marked.at(x, y) == drawing::Rgb{170, 170, 170} ? 1 : 0;
    }
  }
  EXPECT_GT(grey, 500);
}

// A localisation in the map of another building.
TEST(Results, ThatMostScansWereLostIsAWarning) {
  EXPECT_EQ(nodmap::test::logged([&] {
              log_scans({.all = 10, .tracked = 2, .degraded = 1, .by_odometry = 2, .lost = 5});
            }),
            "info: scans: 2 tracked, 3 degraded, 5 lost of 10\n");
  EXPECT_EQ(nodmap::test::logged([&] {
              log_scans({.all = 11, .tracked = 2, .degraded = 1, .by_odometry = 2, .lost = 6});
            }),
            "warning: scans: 2 tracked, 3 degraded, 6 lost of 11\n");
  EXPECT_EQ(nodmap::test::logged([&] { log_scans({}); }),
            "info: scans: 0 tracked, 0 degraded, 0 lost of 0\n");
}

}  // namespace results_test
}  // namespace nodmap::slam2d
