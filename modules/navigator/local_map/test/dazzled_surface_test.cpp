// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/dazzled_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace dazzled_surface_test {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kFree = std::numeric_limits<float>::infinity();

using Ranges = std::vector<std::optional<double>>;

Ranges ranges_of(std::vector<float> ranges_m) {
  scan::Scan scan;
  scan.angle_step_rad = geometry::deg_to_rad(1.0);
  scan.range_min_m = 0.05;
  scan.range_max_m = 8.0;
  scan.ranges_m = std::move(ranges_m);
  return dazzled_ranges(scan);
}

TEST(DazzledSurface, GoesOnAtTheRangeOfTheNearerSurfaceBesideIt) {
  EXPECT_EQ(ranges_of({4, 2, kNaN, kNaN, 3, 3}), (Ranges{{}, {}, 2, 2, {}, {}}));
  EXPECT_EQ(ranges_of({4, kNaN, kFree, kNaN, kNaN, 1}), (Ranges{{}, 4, {}, 1, 1, {}}));
  EXPECT_EQ(ranges_of({kNaN, 2, kNaN}), (Ranges{2, {}, 2}));
}

TEST(DazzledSurface, WithoutASurfaceBesideItIsNowhere) {
  EXPECT_EQ(ranges_of({kNaN, kNaN}), (Ranges{{}, {}}));
  EXPECT_EQ(ranges_of({2, kFree, kNaN, kFree, 2}), Ranges(5));
  EXPECT_EQ(ranges_of({}), Ranges());
}

// A reflector dazzles within 15 degrees of a right angle, which is 30 degrees of a scan.
TEST(DazzledSurface, ThatIsWiderThanAReflectorCanBeIsNowhere) {
  for (const std::size_t width : {31U, 32U}) {
    std::vector<float> ranges_m(width + 2, kNaN);
    ranges_m.front() = ranges_m.back() = 2.0F;
    const Ranges assumed_m = ranges_of(ranges_m);
    EXPECT_EQ(std::ranges::count(assumed_m, std::optional(2.0)), width == 31U ? 31 : 0);
  }
}

// A driver may use only ranges that are shorter than the laser's longest.
TEST(DazzledSurface, ARangeBeyondTheLongestOneIsNotDazzled) {
  EXPECT_EQ(ranges_of({2, 9, 9, kNaN, 2}), (Ranges{{}, {}, {}, 2, {}}));
}

// A reflecting board across the way, 1 m ahead of the laser. Within 15 degrees of a right angle,
// 27 cm to each side, it dazzles; only its left end is measured.
TEST(DazzledSurface, ABoardIsAnObstacleWhereItDazzles) {
  const test::Ground board{{{{1.15, -0.2}, {1.2, 0.5}, 0.6}}};
  LocalMap map({}, {});
  for (double deg = -12.0; deg <= 5.0; deg += 1.5) {
    scan::Scan scan = test::scan_of(board, {}, geometry::deg_to_rad(deg));
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const bool is_board = scan.ranges_m[i] < 1.3F;
      if (is_board && std::abs(scan.angle_rad(i)) < geometry::deg_to_rad(15.0)) {
        scan.ranges_m[i] = kNaN;
      }
    }
    map.add_scan(scan, {});
  }
  // 4 % is 4 cm, which is within the next cell but one.
  for (double y = -0.15; y < 0.5; y += 0.05) {
    bool is_blocked = false;
    for (double x = 1.10; x < 1.22; x += 0.0125) {
      is_blocked = is_blocked || test::is_blocked_at(map, {x, y});
    }
    EXPECT_TRUE(is_blocked) << y;
  }
  EXPECT_FALSE(test::is_blocked_at(map, {1.16, -0.4}));
}

}  // namespace dazzled_surface_test
}  // namespace nodmap::navigator
