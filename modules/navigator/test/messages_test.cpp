// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/geometry/angle.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace messages_test {

using nodmap::local_map_t;

// A box to the left ahead, a pit to the right.
LocalMap scanned_map() {
  LocalMap map({}, {});
  const test::Ground ground{{{{1.0, 0.1}, {1.4, 0.6}, 0.3}, {{0.9, -0.8}, {1.6, -0.2}, -0.5}}};
  for (double deg = -60.0; deg <= 5.0; deg += 0.5) {
    map.add_scan(test::scan_of(ground, {}, geometry::deg_to_rad(deg)), {});
  }
  return map;
}

std::int8_t kind_at(const local_map_t& message, double x_m, double y_m) {
  const int column = static_cast<int>((x_m - message.origin_m[0]) / message.cell_size_m);
  const int row = static_cast<int>((y_m - message.origin_m[1]) / message.cell_size_m);
  return message.cells.at(static_cast<std::size_t>(row * message.width + column));
}

TEST(LocalMapMessage, ShowsFloorBoxAndPitWhereTheyAre) {
  const local_map_t message = local_map_message(scanned_map(), {0.0, 0.0}, 2.0);
  EXPECT_EQ(message.width, 80);
  EXPECT_EQ(message.num_cells, 80 * 80);
  EXPECT_EQ(message.cells.size(), 80U * 80U);
  EXPECT_EQ(kind_at(message, 0.8, 0.02), local_map_t::FLOOR);
  EXPECT_EQ(kind_at(message, 1.01, 0.3), local_map_t::OBSTACLE);
  EXPECT_EQ(kind_at(message, 1.0, -0.5), local_map_t::HOLE);
  EXPECT_EQ(kind_at(message, -1.0, 0.0), local_map_t::NOT_SEEN);
}

// Oracle: each cell of the message is the worst of the four cells of the local map in it. Around a
// place at the edge of the local map half of the cells are outside.
TEST(LocalMapMessage, ACellIsTheWorstOfTheFourThatItHolds) {
  const LocalMap map = scanned_map();
  const double cell_m = map.grid().cell_size_m();
  const double edge_m = (map.grid().first().x() + map.grid().size()) * cell_m;
  for (const Eigen::Vector2d& middle :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.31, -0.77), Eigen::Vector2d(edge_m, 0.2)}) {
    const local_map_t message = local_map_message(map, middle, 1.5);
    for (int i = 0; i < message.num_cells; ++i) {
      std::int8_t worst = local_map_t::NOT_SEEN;
      for (int part = 0; part < 4; ++part) {
        const Eigen::Vector2d p_odom =
            Eigen::Vector2d(message.origin_m[0], message.origin_m[1]) +
            message.cell_size_m * Eigen::Vector2d(i % message.width, i / message.width) +
            cell_m * Eigen::Vector2d(0.5 + part % 2, 0.5 + part / 2);
        if (const LocalCell* cell = map.cell_at(p_odom)) {
          worst = std::max(worst, cell->is_hole()         ? local_map_t::HOLE
                                  : map.is_blocked(*cell) ? local_map_t::OBSTACLE
                                  : cell->is_floor        ? local_map_t::FLOOR
                                                          : local_map_t::NOT_SEEN);
        }
      }
      ASSERT_EQ(message.cells[static_cast<std::size_t>(i)], worst) << middle << " " << i;
    }
  }
}

// Otherwise the drawn map would flicker while the robot moves.
TEST(LocalMapMessage, ACellCoversTheSameGroundInTheNextMessage) {
  const LocalMap map = scanned_map();
  for (double x_m = -0.1; x_m < 0.1; x_m += 0.013) {
    const local_map_t message = local_map_message(map, {x_m, 2.0 * x_m}, 1.0);
    for (const double corner_m : message.origin_m) {
      const double cells = corner_m / message.cell_size_m;
      EXPECT_NEAR(cells, std::round(cells), 1e-9);  // rounding of a product and a quotient
    }
    // The robot is within the two middle cells, to 2.5 cm.
    EXPECT_NEAR(message.origin_m[0] + 1.0, x_m, 0.05);
  }
}

nodmap::goal_t goal_at(double x_m, double y_m, double tolerance_m) {
  nodmap::goal_t goal{};
  goal.is_active = 1;
  goal.position_m[0] = x_m;
  goal.position_m[1] = y_m;
  goal.tolerance_m = tolerance_m;
  return goal;
}

// Cell indices have 32 bits.
TEST(GoalMessage, IsNotFartherAwayThanAnyRobotDrives) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(is_plausible(goal_at(1e6, -1e6, 0.5)));
  for (const double wrong : {1.1e6, -1.1e6, 1e300, -1e300, nan, infinity, -infinity}) {
    EXPECT_FALSE(is_plausible(goal_at(wrong, 0.0, 0.5))) << wrong;
    EXPECT_FALSE(is_plausible(goal_at(0.0, wrong, 0.5))) << wrong;
    EXPECT_FALSE(is_plausible(goal_at(0.0, 0.0, wrong))) << wrong;
  }
  EXPECT_FALSE(is_plausible(goal_at(0.0, 0.0, 0.0)));
  nodmap::goal_t cancelled = goal_at(nan, nan, nan);
  cancelled.is_active = 0;
  EXPECT_TRUE(is_plausible(cancelled));
}

TEST(NavigatorMessages, ARangeFinderWithNothingInItsRangeIsNotSilent) {
  nodmap::base_sensors_t message{};
  message.infrared_m[0] = 0.25F;
  message.infrared_raw[0] = 200;
  message.infrared_m[1] = std::numeric_limits<float>::quiet_NaN();
  message.infrared_raw[1] = 60;
  message.infrared_m[2] = std::numeric_limits<float>::quiet_NaN();
  message.infrared_raw[2] = -1;
  const Proximity::Ranges ranges_m = ranges_of(message);
  EXPECT_EQ(ranges_m[0], 0.25);
  EXPECT_EQ(ranges_m[1], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(ranges_m[2]));
}

}  // namespace messages_test
}  // namespace nodmap::navigator
