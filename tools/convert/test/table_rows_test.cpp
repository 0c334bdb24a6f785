// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/table_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>

namespace nodmap::convert {
namespace table_rows_test {

template <class Message>
std::string row_of(const Message& message) {
  std::ostringstream out;
  put_row(out, message);
  return out.str();
}

// Checks that a row of a message without lists has a value for each name in the header.
template <class Message>
class FlatRow : public testing::Test {};

using FlatMessages = testing::Types<nodmap::odometry_t, nodmap::pose_t, nodmap::pitch_state_t,
                                    nodmap::pitch_command_t, nodmap::navigation_t>;
TYPED_TEST_SUITE(FlatRow, FlatMessages);

TYPED_TEST(FlatRow, HasAsManyColumnsAsItsHeader) {
  const TypeParam message{};
  const std::string row = row_of(message);
  const std::string header = row_header(message);
  EXPECT_GT(std::ranges::count(header, ','), 0);
  EXPECT_EQ(std::ranges::count(row, ','), std::ranges::count(header, ','));
}

TEST(TableRows, PitchState) {
  nodmap::pitch_state_t message{};
  message.pitch_rad = 0.1;
  message.pitch_rate_rad_s = -2.5;
  message.pitch_is_measured = 1;
  message.goal_pitch_rad = 0.2;
  message.goal_speed_rad_s = 3.0;
  message.sweep_count = 7;
  EXPECT_EQ(row_of(message), ",0.1,-2.5,1,0.2,3,7,0");
}

TEST(TableRows, PitchCommand) {
  nodmap::pitch_command_t message{};
  message.pitch_min_rad = -0.5;
  message.pitch_max_rad = 0.25;
  message.sweep_s = 0.3;
  message.max_forward_mps = 1.5;
  EXPECT_EQ(row_of(message), ",-0.5,0.25,0.3,1.5");
}

TEST(TableRows, Navigation) {
  nodmap::navigation_t message{};
  message.behaviour = nodmap::navigation_t::TURN;
  message.steering_angle_rad = -1.0;
  message.corridor_length_m = 2.0;
  message.corridor_width_m = 0.5;
  message.clear_distance_m = std::numeric_limits<double>::infinity();
  message.max_forward_mps = 0.75;
  message.reason = "stale: obstacle map, by \"nobody\"";
  EXPECT_EQ(row_of(message), R"(,2,-1,2,0.5,inf,0.75,"stale: obstacle map, by ""nobody""")");
}

TEST(TableRows, TruthEndsWithThePositionsOfTheActors) {
  nodmap::truth_t message{};
  message.position_m[0] = 1.5;
  message.orientation[0] = 1.0;
  message.forward_mps = 0.5;
  message.yaw_rate_rad_s = -0.25;
  message.pitch_rad = 0.125;
  message.clearance_m = 2.0;
  message.collisions = 3;
  message.bumps = 4;
  message.num_actors = 2;
  message.actor_position_m = {{5.0, 6.0}, {7.0, 8.0}};
  EXPECT_EQ(row_of(message), ",1.5,0,0,1,0,0,0,0.5,-0.25,0.125,2,3,4,5,6,7,8");
}

TEST(TableRows, MapEndsWithItsPointsBinByBin) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  nodmap::egomap_t message{};
  message.orientation[0] = 1.0;
  message.bin_first_rad = -0.5;
  message.bin_step_rad = 0.25;
  message.num_bins = 2;
  message.point_x_m = {1.0F, none};
  message.point_y_m = {2.0F, none};
  message.point_z_m = {0.5F, none};
  EXPECT_EQ(row_of(message), ",0,0,0,1,0,0,0,-0.5,0.25,1,2,0.5,nan,nan,nan");
}

}  // namespace table_rows_test
}  // namespace nodmap::convert
