// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/kurt_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace kurt_frames_test {

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> data) {
  CanFrame f;
  f.id = id;
  f.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, f.data.begin());
  return f;
}

TEST(KurtFrames, GoldenCommands) {
  EXPECT_EQ(hard_stop(), frame(1, {0x00, 0x00, 0x01, 0x03, 0xFF, 0x01, 0x03, 0xFF}));
  EXPECT_EQ(speed_command({0.5, 0.5}), frame(1, {0x00, 0x02, 0x00, 0x32, 0x00, 0x32, 0x00, 0x01}));
  EXPECT_EQ(speed_command({-0.2, 0.2}), frame(1, {0x00, 0x02, 0xFF, 0xEC, 0x00, 0x14, 0x00, 0x01}));
  EXPECT_EQ(speed_command({0.0, 0.0}), frame(1, {0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01}));
}

TEST(KurtFrames, SpeedsAreRoundedToACentimetrePerSecond) {
  EXPECT_EQ(speed_command({0.004, 0.006}), speed_command({0.0, 0.01}));
  EXPECT_EQ(speed_command({-0.004, -0.006}), speed_command({0.0, -0.01}));
}

TEST(KurtFrames, SpeedsThatAreNotFiniteAreZeroAndNothingWrapsAround) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(speed_command({nan, infinity}), speed_command({0.0, 0.0}));
  EXPECT_EQ(speed_command({1e9, -1e9}), frame(1, {0x00, 0x02, 0x7F, 0xFF, 0x80, 0x01, 0x00, 0x01}));
}

TEST(KurtFrames, EncoderTicksAreSigned) {
  const Report report = decode(frame(9, {0x00, 0x64, 0xFF, 0x9C, 0, 0, 0, 0}));
  const auto* ticks = std::get_if<EncoderTicks>(&report);
  ASSERT_NE(ticks, nullptr);
  EXPECT_EQ(ticks->left, 100);
  EXPECT_EQ(ticks->right, -100);
  EXPECT_TRUE(std::holds_alternative<EncoderTicks>(decode(frame(9, {0, 0, 0, 0}))));
}

TEST(KurtFrames, AnyBumperCountsAsATouch) {
  EXPECT_FALSE(std::get<Bumpers>(decode(frame(10, {0, 0xFF})))
                   .is_touched);  // the other byte: remote control
  EXPECT_TRUE(std::get<Bumpers>(decode(frame(10, {0x04, 0}))).is_touched);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(decode(frame(10, {}))));
}

TEST(KurtFrames, EachRangeFinderHasItsPlace) {
  const auto back = std::get<RangeReadings>(decode(frame(5, {0, 101, 0, 102, 0, 103, 0, 104})));
  EXPECT_EQ(back.infrared_raw[static_cast<int>(Infrared::kBack)], 101);
  EXPECT_EQ(back.infrared_raw[static_cast<int>(Infrared::kRightBack)], 102);
  EXPECT_EQ(back.infrared_raw[static_cast<int>(Infrared::kRight)], 103);
  EXPECT_FALSE(back.sonar_raw.has_value());
  const auto front = std::get<RangeReadings>(decode(frame(6, {1, 1, 1, 2, 1, 3, 1, 4})));
  EXPECT_EQ(front.infrared_raw[static_cast<int>(Infrared::kRightFront)], 257);
  EXPECT_EQ(front.sonar_raw, 258);
  EXPECT_EQ(front.infrared_raw[static_cast<int>(Infrared::kLeftFront)], 259);
  EXPECT_EQ(front.infrared_raw[static_cast<int>(Infrared::kLeft)], 260);
  const auto left = std::get<RangeReadings>(decode(frame(7, {9, 9, 0, 105, 9, 9, 9, 9})));
  EXPECT_EQ(left.infrared_raw[static_cast<int>(Infrared::kLeftBack)], 105);
}

TEST(KurtFrames, RangesFollowTheSensorsCurves) {
  // 10 + 30000 / 20^1.4 = 462.5: at 10 cm the infrared sensor reads so much.
  EXPECT_NEAR(infrared_range_m(462).value(), 0.10, 2e-4);  // half a step of the converter
  EXPECT_NEAR(infrared_range_m(100).value(), 0.533952, 1e-6);
  EXPECT_NEAR(sonar_range_m(500).value(), 0.672491, 1e-9);
  EXPECT_NEAR(sonar_range_m(1000).value(), 1.225751, 1e-9);
  EXPECT_NEAR(sonar_range_m(100).value(), 0.229883, 1e-9);
  for (const int raw : {-1, 0, 10, 99}) {
    EXPECT_FALSE(infrared_range_m(raw).has_value()) << raw;
  }
  EXPECT_NEAR(infrared_range_m(800).value(), 0.034, 5e-4);
  EXPECT_EQ(infrared_range_m(801), 0.0) << "too near to measure";
  EXPECT_EQ(infrared_range_m(65535), 0.0);
  EXPECT_FALSE(sonar_range_m(99).has_value());
  EXPECT_FALSE(sonar_range_m(1001).has_value());
}

TEST(KurtFrames, TiltIsTheArcSineOfTheAccelerationAndBounded) {
  const auto level = std::get<Tilt>(decode(frame(0x0D, {0x80, 0, 0x80, 0, 0, 0, 0, 0})));
  EXPECT_EQ(level.roll_rad, 0.0);
  EXPECT_EQ(level.pitch_rad, 0.0);
  // 32768 + 1966 is half a g: 30 degrees.
  const auto tilted = std::get<Tilt>(decode(frame(0x0D, {0x87, 0xAE, 0x78, 0x52, 0, 0, 0, 0})));
  EXPECT_NEAR(tilted.roll_rad, geometry::deg_to_rad(30.0), 1e-12);
  EXPECT_NEAR(tilted.pitch_rad, geometry::deg_to_rad(-30.0), 1e-12);
  // A shock of more than 1 g has no angle: the source returns NaN, we the end of the scale.
  const auto shock = std::get<Tilt>(decode(frame(0x0D, {0xFF, 0xFF, 0, 0, 0, 0, 0, 0})));
  EXPECT_NEAR(shock.roll_rad, 0.5 * geometry::kPi, 1e-12);
  EXPECT_NEAR(shock.pitch_rad, -0.5 * geometry::kPi, 1e-12);
}

TEST(KurtFrames, TheGyroIsConvertedFromTheBasesDegrees) {
  // 4992511 = 0x004C2DFF is one degree; 10000 = 0x2710 one square degree.
  const auto gyro =
      std::get<Gyro>(decode(frame(0x0E, {0x00, 0x4C, 0x2D, 0xFF, 0x00, 0x00, 0x27, 0x10})));
  const double degree = geometry::deg_to_rad(1.0);
  EXPECT_NEAR(gyro.yaw_rad, degree, 1e-15);
  EXPECT_NEAR(gyro.variance_rad2, degree * degree, 1e-15);
  const auto right = std::get<Gyro>(decode(frame(0x0E, {0xFF, 0xB3, 0xD2, 0x01, 0, 0, 0, 0})));
  EXPECT_NEAR(right.yaw_rad, -degree, 1e-15);
}

TEST(KurtFrames, MotorCurrentsInAmpere) {
  const auto currents =
      std::get<MotorCurrents>(decode(frame(8, {0x03, 0xE8, 0x07, 0xD0, 0, 0, 0, 0})));
  EXPECT_DOUBLE_EQ(currents.right_a, 1.0);
  EXPECT_DOUBLE_EQ(currents.left_a, 2.0);
}

TEST(KurtFrames, OtherFramesAndTruncatedOnesAreIgnored) {
  const auto says_nothing = [](const CanFrame& f) {
    return std::holds_alternative<std::monostate>(decode(f));
  };
  EXPECT_TRUE(says_nothing(frame(0x004, {1, 2, 3, 4, 5, 6, 7, 8})));
  EXPECT_TRUE(says_nothing(frame(0x7FF, {})));
  EXPECT_TRUE(says_nothing(frame(9, {0, 100, 0})));
  EXPECT_TRUE(says_nothing(frame(5, {0, 100, 0, 100})));
  CanFrame extended = frame(9, {0, 100, 0, 100, 0, 0, 0, 0});
  extended.extended = true;
  EXPECT_TRUE(says_nothing(extended));
  CanFrame remote = frame(9, {0, 0, 0, 0, 0, 0, 0, 0});
  remote.remote = true;
  EXPECT_TRUE(says_nothing(remote));
}

}  // namespace kurt_frames_test
}  // namespace nodmap::kurt
