// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "common/params/params.hpp"
#include "common/robot/robot_params.hpp"
#include "common/robot/stopping.hpp"

namespace nodmap::robot {
namespace robot_test {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kDeceleration = 1.5;

TEST(Robot, IsKurt3dAsInThePaper) {
  const RobotParams robot;
  EXPECT_EQ(robot.body.length_m, 0.45);
  EXPECT_EQ(robot.body.width_m, 0.33);
  EXPECT_EQ(robot.body.height_m, 0.47);
  EXPECT_EQ(robot.corridor_bottom_m(), 0.05);
  EXPECT_EQ(robot.corridor_top_m(), 0.5);
}

TEST(Robot, AKeyOfAnOlderFileGetsAnErrorThatNamesTheNewOne) {
  for (const auto& [old_key, new_key] :
       {std::pair<std::string, std::string>("robot_height_m", "robot.body.height_m"),
        {"mount_z_m", "robot.mount.z_m"},
        {"pitch_rate_rad_s", "robot.head.pitch_rate_rad_s"},
        {"head_clearance_m", "robot.corridor.top_margin_m"},
        {"robot.corridor.head_clearance_m", "robot.corridor.top_margin_m"},
        {"stop_margin_m", "robot.braking.stop_margin_m"}}) {
    RobotParams robot;
    params::Table table(robot);
    EXPECT_NO_THROW(table.set(new_key, "0.4", "test")) << new_key;
    try {
      table.set(old_key, "0.4", "test");
      FAIL() << old_key;
    } catch (const params::ParamError& error) {
      EXPECT_EQ(error.what(), "test: key '" + old_key + "' is now called '" + new_key + "'");
    }
  }
}

// A robot that drives as fast as the free distance permits stops with the margin left.
TEST(Braking, RequiredDistanceAndPermittedSpeedAreInverse) {
  const Braking braking;
  for (double speed_mps = 0.1; speed_mps < 3.0; speed_mps += 0.1) {
    const double distance_m = braking.required_distance_m(speed_mps, 0.7);
    EXPECT_NEAR(distance_m, stopping_distance(speed_mps, 0.7, braking.deceleration_mps2) + 0.15,
                1e-12);
    EXPECT_NEAR(braking.permitted_mps(distance_m, 0.7), speed_mps, 1e-12);  // rounding, both
  }
  EXPECT_EQ(braking.permitted_mps(braking.stop_margin_m, 0.7), 0.0);
}

TEST(Footprint, EndsAtItsBorder) {
  const Footprint body = Body{}.footprint();
  for (const double x_sign : {-1.0, 1.0}) {
    for (const double y_sign : {-1.0, 1.0}) {
      EXPECT_TRUE(body.contains({x_sign * 0.224, y_sign * 0.164}));
      EXPECT_FALSE(body.contains({x_sign * 0.226, y_sign * 0.164}));
      EXPECT_FALSE(body.contains({x_sign * 0.224, y_sign * 0.166}));
      EXPECT_TRUE(body.grown(0.002, 0.002).contains({x_sign * 0.226, y_sign * 0.166}));
      EXPECT_FALSE(body.grown(-0.002, -0.002).contains({x_sign * 0.224, y_sign * 0.0}));
    }
  }
  EXPECT_FALSE(body.contains({std::nan(""), 0.0}));
}

TEST(Footprint, ItsCornersLieOnTheTurningCircle) {
  EXPECT_DOUBLE_EQ((Footprint{0.3, 0.4}.turning_radius_m()), 0.5);
}

struct Row {
  double reaction_s;
  std::array<double, 5> speeds_mps;
};

// Computed by hand from the formula, rounded to 0.01 m/s. Reaction time: two sweeps and 0.05 s; in
// the last row one scan and 0.05 s. Margin: 0.15 m.
TEST(Stopping, SpeedsOfTheReferenceTable) {
  const std::array<double, 5> distances_m{1.0, 1.5, 2.0, 3.0, 4.0};
  const std::array<Row, 5> table{{{2 * 0.20 + 0.05, {1.06, 1.45, 1.78, 2.33, 2.79}},
                                  {2 * 0.35 + 0.05, {0.83, 1.18, 1.49, 2.01, 2.45}},
                                  {2 * 0.67 + 0.05, {0.54, 0.81, 1.06, 1.51, 1.90}},
                                  {2 * 1.33 + 0.05, {0.30, 0.47, 0.63, 0.94, 1.23}},
                                  {0.01332 + 0.05, {1.50, 1.92, 2.26, 2.83, 3.30}}}};
  for (const Row& row : table) {
    for (std::size_t i = 0; i < distances_m.size(); ++i) {
      EXPECT_NEAR(stoppable_speed(distances_m[i] - 0.15, row.reaction_s, kDeceleration),
                  row.speeds_mps[i], 0.01)
          << row.reaction_s << " s, " << distances_m[i] << " m";
    }
  }
}

TEST(Stopping, DistanceAndSpeedAreInverse) {
  for (double v = 0.05; v < 5.0; v += 0.05) {
    // Rounding of a square root.
    EXPECT_NEAR(stoppable_speed(stopping_distance(v, 0.7, kDeceleration), 0.7, kDeceleration), v,
                1e-12);
  }
}

TEST(Stopping, ARobotDrivenStepByStepCoversTheStoppingDistance) {
  constexpr double kStepS = 1e-5;
  const double v = stoppable_speed(1.85, 0.45, kDeceleration);
  double distance_m = 0.0;
  double speed = v;
  for (double t = 0.0; speed > 0.0; t += kStepS) {
    speed -= t < 0.45 ? 0.0 : kDeceleration * kStepS;
    distance_m += speed * kStepS;
  }
  // First-order integration: the distance of a step at full speed, twice.
  EXPECT_NEAR(distance_m, 1.85, 2.0 * v * kStepS);
}

// While the robot drives towards the obstacle, the bound falls by less than the deceleration, so
// that the robot can always follow it.
TEST(Stopping, TheSpeedBoundIsFollowedWithNoMoreThanTheDeceleration) {
  constexpr double kStepS = 1e-4;
  double distance_m = 3.0;
  double speed = stoppable_speed(distance_m, 0.45, kDeceleration);
  while (speed > 0.01) {
    distance_m -= speed * kStepS;
    const double next = stoppable_speed(distance_m, 0.45, kDeceleration);
    EXPECT_LE(speed - next, kDeceleration * kStepS);
    EXPECT_LT(next, speed);
    speed = next;
  }
  EXPECT_GT(distance_m, 0.0);
}

TEST(Stopping, WithoutDistanceThereIsNoSpeed) {
  EXPECT_EQ(stoppable_speed(0.0, 0.1, kDeceleration), 0.0);
  EXPECT_EQ(stoppable_speed(-1.0, 0.1, kDeceleration), 0.0);
  EXPECT_EQ(stoppable_speed(std::nan(""), 0.1, kDeceleration), 0.0);
  EXPECT_EQ(stoppable_speed(kInf, 0.1, kDeceleration), kInf);
}

}  // namespace robot_test
}  // namespace nodmap::robot
