// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/gyro_heading.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace gyro_heading_test {

using geometry::deg_to_rad;
using geometry::rad_to_deg;

constexpr double kPeriodS = 0.01;
constexpr int kAnglePeriods = 7;

// A robot whose wheels and gyro err. The gyro measures in the middle of every seventh period.
struct Drive {
  explicit Drive(const GyroParams& params = {}) : heading(params) {}

  // A period in which the robot rotates at `rate` and its wheels measure `wheels`.
  void step(double rate, double wheels, double path_m) {
    const double before_rad = truth_rad;
    truth_rad += kPeriodS * rate;
    if (has_gyro && ++period % kAnglePeriods == 0) {
      heading.add({read(before_rad + gyro_delay * kPeriodS * rate), 0.0});
    }
    gyro_drift_rad += kPeriodS * bias_rad_s;
    const auto rotation = heading.rotate({.rotation_rad = kPeriodS * wheels,
                                          .path_m = path_m,
                                          .variance_rad2 = std::pow(deg_to_rad(1.0), 2) * path_m});
    heading_rad += rotation.rotation_rad;
    variance_rad2 += rotation.variance_rad2;
    largest_step_rad =
        std::max(largest_step_rad, std::abs(rotation.rotation_rad - kPeriodS * rate));
  }

  // Wheels that measure `ratio` times the robot's rotation; on the spot they roll 0.2 m per radian.
  void rotate(double rate, double duration_s, double ratio = 1.0) {
    for (int i = 0; i < std::lround(duration_s / kPeriodS); ++i) {
      step(rate, ratio * rate, 0.2 * kPeriodS * std::abs(rate) + 0.0005);
    }
  }

  void stand(double duration_s) {
    for (int i = 0; i < std::lround(duration_s / kPeriodS); ++i) {
      step(0.0, 0.0, 0.0);
    }
  }

  double read(double truth) { return wrap(gyro_scale * truth + gyro_drift_rad); }

  [[nodiscard]] double error_deg() const { return rad_to_deg(heading_rad - truth_rad); }

  GyroHeading heading;
  std::function<double(double)> wrap = [](double angle) {
    return geometry::normalize_angle(angle);
  };
  bool has_gyro = true;
  double gyro_delay = 0.5;  // of a period
  double gyro_scale = 1.0;
  double bias_rad_s = 0.0;
  double gyro_drift_rad = 0.0;
  double truth_rad = 0.0;
  double heading_rad = 0.0;
  double variance_rad2 = 0.0;
  double largest_step_rad = 0.0;
  int period = 0;
};

TEST(GyroHeading, WithAPerfectGyroTheErrorDoesNotDependOnTheWheels) {
  for (const double ratio : {0.9, 1.0, 1.03, 1.1}) {
    Drive drive;
    drive.gyro_drift_rad = 2.9;  // the driver may start at any angle of the gyro
    drive.bias_rad_s = deg_to_rad(0.4);
    drive.stand(4.0);
    ASSERT_EQ(drive.heading.use(), GyroUse::kUsed);
    ASSERT_NEAR(*drive.heading.bias_rad_s(), drive.bias_rad_s, 1e-12);
    for (const double rate : {2.0, -1.0, 0.3, -2.0}) {
      drive.rotate(rate, 3.0, ratio);
    }
    drive.stand(0.2);
    EXPECT_NEAR(drive.error_deg(), 0.0, 1e-9) << ratio;
    EXPECT_EQ(drive.heading.counts().refused, 0);
  }
}

// SensorInput takes a step of more than 6 degrees for a jump; scan matching would notice a tenth of
// one.
TEST(GyroHeading, TheHeadingHasNoSteps) {
  Drive drive;
  drive.stand(4.0);
  drive.rotate(2.0, 3.0, 1.1);
  drive.rotate(-2.0, 3.0, 1.1);
  drive.stand(1.0);
  // Of 1.15 degrees of a period the wheels err by a tenth, twice that while they are corrected.
  EXPECT_LT(rad_to_deg(drive.largest_step_rad), 0.35);
}

// Without the prediction the heading would be up to 3 % of 8 degrees behind, those of an interval.
TEST(GyroHeading, TheWheelsAreTakenToSlipAsInTheLastInterval) {
  Drive drive;
  drive.stand(4.0);
  drive.rotate(2.0, 0.3, 1.03);
  for (int i = 0; i < 200; ++i) {
    drive.rotate(2.0, kPeriodS, 1.03);
    EXPECT_NEAR(drive.error_deg(), 0.0, 0.01);
  }
}

// An angle is taken to be half a period old; it may be a whole one or none.
TEST(GyroHeading, TheUnknownTimeOfAnAngleCostsOnlyWhileRotating) {
  for (const double delay : {0.0, 1.0}) {
    Drive drive;
    drive.gyro_delay = delay;
    drive.stand(4.0);
    drive.rotate(2.0, 3.0);
    EXPECT_NEAR(std::abs(drive.error_deg()), rad_to_deg(2.0 * 0.5 * kPeriodS), 0.01) << delay;
    drive.stand(0.2);
    EXPECT_NEAR(drive.error_deg(), 0.0, 1e-9);
  }
}

TEST(GyroHeading, WithoutAGyroItIsTheWheels) {
  for (const bool is_off : {false, true}) {
    GyroParams params;
    params.use_gyro = !is_off;
    Drive drive(params);
    drive.has_gyro = is_off;
    drive.stand(4.0);
    drive.rotate(1.0, 1.0, 1.1);
    EXPECT_EQ(drive.heading.use(), is_off ? GyroUse::kOff : GyroUse::kAbsent);
    EXPECT_NEAR(drive.heading_rad, 1.1, 1e-12);
    EXPECT_NEAR(drive.variance_rad2, std::pow(deg_to_rad(1.0), 2) * 0.25, 1e-12);
    EXPECT_EQ(fault_of(drive.heading.use()), "");
  }
}

TEST(GyroHeading, UntilTheBiasIsMeasuredTheWheelsCount) {
  Drive drive;
  drive.bias_rad_s = deg_to_rad(1.0);
  drive.rotate(1.0, 5.0, 1.1);
  EXPECT_EQ(drive.heading.use(), GyroUse::kUnsettled);
  EXPECT_NEAR(drive.heading_rad, 5.5, 1e-12);
  EXPECT_FALSE(drive.heading.bias_rad_s());
}

// Slow rotations of wheels that err by a tenth are no evidence about the gyro.
TEST(GyroHeading, TheBiasIsMeasuredOnlyWhileTheWheelsAreStill) {
  Drive drive;
  drive.bias_rad_s = deg_to_rad(0.4);
  drive.stand(4.0);
  const double measured = *drive.heading.bias_rad_s();
  drive.rotate(0.1, 60.0, 1.1);
  EXPECT_EQ(*drive.heading.bias_rad_s(), measured);
  drive.bias_rad_s = deg_to_rad(0.45);
  drive.stand(20.0);
  EXPECT_NEAR(rad_to_deg(*drive.heading.bias_rad_s()), 0.45, 0.02);
}

TEST(GyroHeading, StationaryItStaysAsItIs) {
  Drive drive;
  drive.bias_rad_s = deg_to_rad(0.4);
  drive.stand(600.0);
  EXPECT_EQ(drive.heading_rad, 0.0);
  EXPECT_EQ(drive.variance_rad2, 0.0);
}

// By hand, with its wheels still. The bias of a gyro does not change like this.
TEST(GyroHeading, TurningAStationaryRobotDoesNotChangeTheBias) {
  Drive drive;
  drive.stand(4.0);
  for (int i = 0; i < 300; ++i) {
    drive.step(deg_to_rad(2.0), 0.0, 0.0);
  }
  drive.stand(2.0);
  EXPECT_NEAR(*drive.heading.bias_rad_s(), 0.0, 1e-9);
}

TEST(GyroHeading, ABiasThatHasChangedForGoodIsTaken) {
  Drive drive;
  drive.stand(4.0);
  drive.bias_rad_s = deg_to_rad(2.0);
  drive.stand(8.0);
  EXPECT_NEAR(*drive.heading.bias_rad_s(), drive.bias_rad_s, 1e-9);
}

TEST(GyroHeading, AGyroThatRunsOffIsNotUsed) {
  Drive drive;
  drive.stand(4.0);
  drive.bias_rad_s = deg_to_rad(6.0);
  drive.stand(8.0);
  EXPECT_EQ(drive.heading.use(), GyroUse::kRunsOff);
  drive.rotate(1.0, 2.0, 1.05);
  EXPECT_NEAR(drive.heading_rad, 2.1, 1e-12);
  EXPECT_NE(fault_of(drive.heading.use()), "");
}

TEST(GyroHeading, ASilentGyroLeavesTheHeadingToTheWheels) {
  Drive drive;
  drive.stand(4.0);
  drive.rotate(1.0, 1.0);
  drive.has_gyro = false;
  drive.rotate(1.0, 1.0, 1.1);
  EXPECT_EQ(drive.heading.use(), GyroUse::kSilent);
  EXPECT_EQ(drive.heading.counts().silences, 1);
  EXPECT_NEAR(drive.heading_rad, 2.1, 0.01);
  drive.has_gyro = true;  // what it rotated meanwhile is not made up for
  drive.rotate(-1.0, 2.0, 1.1);
  EXPECT_EQ(drive.heading.use(), GyroUse::kUsed);
  EXPECT_NEAR(rad_to_deg(drive.heading_rad - drive.truth_rad), rad_to_deg(0.1), 1.0);
}

TEST(GyroHeading, AGyroThatIsZeroedCostsNoMoreThanTheWheelsErr) {
  Drive drive;
  drive.stand(4.0);
  drive.rotate(1.0, 2.0);
  drive.gyro_drift_rad -= drive.truth_rad;
  drive.rotate(1.0, 0.1);
  EXPECT_EQ(drive.heading.use(), GyroUse::kDisagrees);
  EXPECT_NEAR(drive.error_deg(), 0.0, 1e-6);
  drive.rotate(1.0, 4.0);
  EXPECT_EQ(drive.heading.use(), GyroUse::kUsed) << "it has followed the wheels since";
  EXPECT_NEAR(drive.error_deg(), 0.0, 1e-6);
  EXPECT_GT(drive.heading.counts().refused, 0);
}

// Anything smaller than the margin of 3 degrees cannot be told from slip.
TEST(GyroHeading, AJumpCostsNoMoreThanTheMargin) {
  for (const double jump_deg : {2.0, 5.0, 30.0, 179.0}) {
    Drive drive;
    drive.stand(4.0);
    drive.rotate(0.5, 2.0);
    drive.gyro_drift_rad += deg_to_rad(jump_deg);
    drive.rotate(0.5, 2.0);
    drive.stand(1.0);
    EXPECT_LT(std::abs(drive.error_deg()), 3.0) << jump_deg;
  }
}

TEST(GyroHeading, AFrozenGyroIsNotBelieved) {
  Drive drive;
  drive.stand(4.0);
  drive.rotate(1.0, 1.0);
  drive.wrap = [](double /*angle*/) { return 1.0; };
  drive.rotate(1.0, 1.0);
  EXPECT_EQ(drive.heading.use(), GyroUse::kFrozen);
  // One interval, in which the angle jumped to the one that it repeats.
  EXPECT_NEAR(drive.error_deg(), 0.0, 4.1);
}

TEST(GyroHeading, AGyroOfTheWrongSignIsNoticedAndStaysOff) {
  Drive drive;
  drive.gyro_scale = -1.0;
  drive.stand(4.0);
  for (int i = 0; i < 10; ++i) {
    drive.rotate(1.0, 2.0);
    drive.stand(2.0);
  }
  EXPECT_EQ(drive.heading.use(), GyroUse::kDisagrees);
  // Once, by what it and the wheels rotate until they differ by more than slip.
  EXPECT_LT(std::abs(drive.error_deg()), 10.0);
  GyroParams reversed;
  reversed.scale = -1.0;
  Drive corrected(reversed);
  corrected.gyro_scale = -1.0;
  corrected.stand(4.0);
  corrected.rotate(1.0, 2.0, 1.1);
  corrected.stand(0.2);
  EXPECT_NEAR(corrected.error_deg(), 0.0, 1e-9);
}

// A person or a wall holds the robot: the wheels spin, and the gyro knows.
TEST(GyroHeading, WheelsThatSpinDoNotRotateTheRobot) {
  Drive drive;
  drive.stand(4.0);
  drive.bias_rad_s = deg_to_rad(0.01);  // a living gyro does not repeat an angle
  for (int i = 0; i < 100; ++i) {
    drive.step(0.0, 0.5, 0.1 * kPeriodS);
  }
  drive.stand(0.2);
  EXPECT_NEAR(drive.error_deg(), 0.0, 0.05);
}

TEST(GyroHeading, ItWrapsWhereverItsAnglesEnd) {
  for (const double range_rad : {2.0 * geometry::kPi, kGyroRangeRad}) {
    for (const double rate : {2.0, -2.0}) {
      Drive drive;
      drive.wrap = [range_rad](double angle) { return std::remainder(angle, range_rad); };
      drive.stand(4.0);
      drive.rotate(rate, 20.0, 1.05);
      drive.stand(0.2);
      EXPECT_NEAR(drive.error_deg(), 0.0, 1e-9) << range_rad << " " << rate;
      EXPECT_EQ(drive.heading.counts().refused, 0);
    }
  }
}

TEST(GyroHeading, AfterAGapItBeginsAnew) {
  Drive drive;
  drive.stand(4.0);
  drive.rotate(1.0, 1.0, 1.1);
  drive.heading.interrupt();
  drive.truth_rad += 1.0;  // nobody knows
  drive.rotate(1.0, 1.0, 1.1);
  drive.stand(0.2);
  // What the correction still owed at the gap, and what the wheels err until the next two angles.
  EXPECT_NEAR(drive.heading_rad, 2.0, 0.02);
  EXPECT_EQ(drive.heading.counts().refused, 0);
}

// Oracle: the errors of gyros with the noise and the bias walk that the parameters state, after
// half a minute of driving.
TEST(GyroHeading, ItsVarianceIsThatOfItsErrors) {
  GyroParams params;
  params.scale_sigma = 0.0;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  double sum_sq = 0.0;
  constexpr int kDrives = 300;
  double variance_rad2 = 0.0;
  for (int i = 0; i < kDrives; ++i) {
    Drive drive(params);
    const auto noisy = [&](double rate, double duration_s) {
      for (int k = 0; k < std::lround(duration_s / kPeriodS); ++k) {
        drive.bias_rad_s += params.bias_walk_rad_s * std::sqrt(kPeriodS) * normal(random);
        drive.gyro_drift_rad += params.noise_rad * std::sqrt(kPeriodS) * normal(random);
        drive.step(rate, 1.03 * rate, rate == 0.0 ? 0.0 : 0.005);
      }
    };
    drive.bias_rad_s = deg_to_rad(0.3);
    noisy(0.0, 8.0);
    for (int turn = 0; turn < 5; ++turn) {
      noisy(0.5, 3.0);
      noisy(-0.5, 3.0);
    }
    sum_sq += std::pow(drive.heading_rad - drive.truth_rad, 2);
    variance_rad2 = drive.variance_rad2;
  }
  const double ratio = std::sqrt(sum_sq / kDrives / variance_rad2);
  EXPECT_NEAR(ratio, 1.0, 0.12);  // a deviation of 300 samples is known to 4 %; three times that
}

}  // namespace gyro_heading_test
}  // namespace nodmap::kurt
