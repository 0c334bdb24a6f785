// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/map_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "tests/support/data_dir.hpp"

namespace nodmap::slam2d {
namespace {

std::string slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

TEST(MapFile, RosMapHasTheRobotsLeftAtTheTop) {
  const test::TemporaryDir dir;
  OccupancyGrid grid(0.5);
  ASSERT_TRUE(grid.add_ray({0.25, 0.25}, {0.25, 1.25}));  // a wall to the left; y is up
  write_ros_map(dir.path(), grid);

  const std::string pgm = slurp(dir.path() / "map.pgm");
  const std::string head =
      "P5\n" + std::to_string(grid.width()) + " " + std::to_string(grid.height()) + "\n255\n";
  ASSERT_EQ(pgm.substr(0, head.size()), head);
  ASSERT_EQ(pgm.size(), head.size() + static_cast<std::size_t>(grid.width() * grid.height()));
  const auto pixel = [&](double x_m, double y_m) {
    const int x = static_cast<int>(std::floor((x_m - grid.origin().x()) / 0.5));
    const int y = static_cast<int>(std::floor((y_m - grid.origin().y()) / 0.5));
    return static_cast<unsigned char>(
        pgm[head.size() + static_cast<std::size_t>((grid.height() - 1 - y) * grid.width() + x)]);
  };
  EXPECT_EQ(pixel(0.25, 0.25), 254);
  EXPECT_EQ(pixel(0.25, 1.25), 0);
  EXPECT_EQ(pixel(1.25, 0.25), 205);

  const std::string yaml = slurp(dir.path() / "map.yaml");
  EXPECT_NE(yaml.find("image: map.pgm\n"), std::string::npos);
  EXPECT_NE(yaml.find("resolution: 0.5\n"), std::string::npos);
  EXPECT_NE(yaml.find("origin: [-50, -50, 0]\n"), std::string::npos);
}

TEST(MapFile, AFolderThatIsMissingIsNamed) {
  try {
    write_ros_map("/nonexistent/folder", OccupancyGrid(0.05));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nonexistent/folder/map.pgm"), std::string::npos);
  }
}

TEST(MapFile, ImagesOfNothingAndOfAPath) {
  EXPECT_GT(draw_paths({}, {}).width(), 0);
  EXPECT_GT(draw_map(OccupancyGrid(0.05), {}).width(), 0);
  const std::vector<geometry::SE2> path{{0, 0, 0}, {10, 0, 0}};
  const drawing::Image image = draw_paths(path, {});
  // 10 m and a metre of border on either side: the path runs through the middle.
  EXPECT_NE(image.at(image.width() / 2, image.height() / 2), drawing::kWhite);
  EXPECT_EQ(image.at(image.width() / 2, 2), drawing::kWhite);
}

TEST(MapFile, ASmallMapFillsAScreenAndALargeOneLosesNoCell) {
  OccupancyGrid coarse(0.5);
  ASSERT_TRUE(coarse.add_ray({0.25, 0.25}, {0.25, 1.25}));
  const drawing::Image small = draw_map(coarse, {});
  EXPECT_EQ(std::max(small.width(), small.height()), 1200);
  OccupancyGrid fine(0.05);
  ASSERT_TRUE(fine.add_ray({0.0, 0.0}, {0.0, 1.0}));
  const drawing::Image large = draw_map(fine, {});
  EXPECT_GE(large.width(), fine.width());
}

TEST(MapFile, StartEndAndOdometryAreMarked) {
  const std::vector<geometry::SE2> path{{0, 0, 0}, {10, 0, 0}};
  const std::vector<geometry::SE2> odometry{{0, 0, 0}, {10, 1, 0}};
  const drawing::Image one = draw_paths(path, {});
  const drawing::Image marked = draw_paths(path, odometry);
  // Beside the line, whose half width is a pixel, where the path starts: the disc.
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

}  // namespace
}  // namespace nodmap::slam2d
