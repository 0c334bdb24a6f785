// SPDX-License-Identifier: BSD-3-Clause
// The drivers connected to the simulator's devices, which share no code with them: every byte is
// exchanged, on simulated time. What the drivers publish is compared with the true state.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "common/geometry/angle.hpp"
#include "drivers/kurt/kurt.hpp"
#include "drivers/laser3d/laser3d.hpp"
#include "sim/devices/dynamixel_servo.hpp"
#include "sim/devices/kurt_base.hpp"
#include "sim/devices/lms200.hpp"

namespace nodmap {
namespace drivers_on_devices_test {

constexpr time::Duration kPollPeriod = 2ms;  // how often a driver's process checks its time-outs

// Four walls, so that every level beam hits something, at various ranges.
sim::World room() {
  sim::World world;
  for (const double side : {-1.0, 1.0}) {
    world.objects.push_back({sim::Box{{4.0 * side, 0.0, 1.5}, {0.2, 8.0, 3.0}, 0.0}});
    world.objects.push_back({sim::Box{{0.0, 3.0 * side, 1.5}, {8.0, 0.2, 3.0}, 0.0}});
  }
  return world;
}

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

// A driver's serial line as an adapter provides it: at `baud`, bytes arrive as soon as they have
// been sent.
struct Cable {
  sim::SerialDevice& device;
  int baud;

  sim::Bytes read(time::SteadyTime now) {
    sim::Bytes bytes;
    device.transmit(now, baud, bytes);
    return bytes;
  }
};

// The scanner's driver, connected to its two devices.
class ScannerRun {
 public:
  ScannerRun(const laser3d::Laser3dParams& params, const sim::Lms200Params& laser,
             const sim::World& world = room())
      : model_(world, {}, 1),
        driver_(params),
        lms_(laser,
             [this](double angle_rad, time::SteadyTime now) { return fire(angle_rad, now); }) {
    execute(driver_.laser_opened({}));
    execute(driver_.servo_opened({}));
  }

  void run_until(time::SteadyTime end) {
    while (now_ < end) {
      now_ = std::min({lms_.next_due(), dynamixel_.next_due(), next_poll_, end});
      model_.advance_to(now_);
      true_pitch_rad_[now_] = model_.pitch_rad();
      if (const sim::Bytes bytes = laser_.read(now_); !bytes.empty()) {
        execute(driver_.receive_laser(bytes, now_));
      }
      if (const sim::Bytes bytes = servo_.read(now_); !bytes.empty()) {
        execute(driver_.receive_servo(bytes, now_));
      }
      if (now_ >= next_poll_) {
        next_poll_ = now_ + kPollPeriod;
        execute(driver_.poll(now_));
      }
    }
  }

  // Difference between the stamp of a scan and the time at which its first beam was fired.
  [[nodiscard]] time::Duration stamp_error(const scan::Scan& scan) const {
    const std::vector<time::SteadyTime>& fired = fired_.at(std::lround(1e4 * scan.angle_first_rad));
    const time::SteadyTime stamp = first_beam(scan);
    const auto after = std::lower_bound(fired.begin(), fired.end(), stamp);
    time::Duration error = after == fired.end() ? time::Duration::max() : *after - stamp;
    if (after != fired.begin()) {
      error = std::min(error, stamp - *(after - 1));
    }
    return error;
  }

  [[nodiscard]] double true_pitch_rad(const scan::Scan& scan) const {
    const time::SteadyTime stamp = first_beam(scan);
    const auto after = true_pitch_rad_.lower_bound(stamp);
    const auto before = std::prev(after);
    const double fraction = time::FineDuration(stamp - before->first) /
                            time::FineDuration(after->first - before->first);
    return before->second + fraction * (after->second - before->second);
  }

  std::vector<scan::Scan> scans;
  const laser3d::Laser3d& driver() const { return driver_; }

 private:
  // Here the stamps of the scans are on the clock of the devices.
  static time::SteadyTime first_beam(const scan::Scan& scan) {
    return at(scan.stamp.time_since_epoch());
  }

  sim::Echo fire(double angle_rad, time::SteadyTime now) {
    fired_[std::lround(1e4 * angle_rad)].push_back(now);
    return model_.measure(angle_rad, now);
  }

  void execute(laser3d::Laser3dOutput output) {
    for (laser3d::SteadyScan& scan : output.scans) {
      scan.scan.stamp = time::Timestamp(scan.first_beam.time_since_epoch());
      scans.push_back(std::move(scan.scan));
    }
    for (const auto& [actions, cable] :
         {std::pair{&output.laser, &laser_}, {&output.servo, &servo_}}) {
      for (const laser3d::LineAction& action : *actions) {
        cable->baud = action.baud.value_or(cable->baud);
        if (!action.send.empty()) {
          cable->device.receive(action.send, cable->baud, now_);
        }
      }
    }
  }

  time::SteadyTime now_{};
  time::SteadyTime next_poll_{};
  std::map<std::int64_t, std::vector<time::SteadyTime>> fired_;  // by angle in 1e-4 rad
  std::map<time::SteadyTime, double> true_pitch_rad_;
  sim::RobotModel model_;
  laser3d::Laser3d driver_;
  sim::Lms200 lms_;
  sim::DynamixelServo dynamixel_{{}, model_};
  Cable laser_{lms_, 500'000};
  Cable servo_{dynamixel_, 1'000'000};
};

struct Case {
  const char* name;
  laser3d::Laser3dParams params;
  double scans_per_s;
};

laser3d::Laser3dParams with(laser3d::SickVariant variant, bool interlaced, laser3d::SickUnit unit) {
  laser3d::Laser3dParams params;
  params.laser.variant = variant;
  params.laser.interlaced = interlaced;
  params.laser.unit = unit;
  return params;
}

class DriversOnDevices : public ::testing::TestWithParam<Case> {};

// R1 and the passive synchronisation: the mirror is 50 ppm slow, and the servo's clock is 30 ppm
// fast.
TEST_P(DriversOnDevices, ScansHaveTheTimeAndPitchOfTheirMeasurement) {
  ScannerRun run(GetParam().params, sim::Lms200Params{});
  run.run_until(at(15s));
  ASSERT_EQ(run.driver().health(at(15s)).reason, "");
  run.scans.clear();
  run.run_until(at(45s));
  const double rate = static_cast<double>(run.scans.size()) / 30.0;
  EXPECT_NEAR(rate, GetParam().scans_per_s, 0.1) << "one or two scans at the ends";
  ASSERT_GT(run.scans.size(), 1000U);
  const double period_ms = 1e3 * time::seconds(run.scans.back().stamp - run.scans.front().stamp) /
                           static_cast<double>(run.scans.size() - 1);
  EXPECT_NEAR(period_ms, 13.32, 0.05) << "R1's own bound";
  EXPECT_EQ(std::ranges::adjacent_find(run.scans, std::ranges::greater_equal{}, &scan::Scan::stamp),
            run.scans.end());
  time::Duration worst{};
  double worst_pitch_rad = 0.0;
  for (const scan::Scan& scan : run.scans) {
    worst = std::max(worst, run.stamp_error(scan));
    worst_pitch_rad =
        std::max(worst_pitch_rad, std::abs(scan.pitch_first_rad - run.true_pitch_rad(scan)));
  }
  EXPECT_LT(worst, 1ms);
  // Half a step of the servo is 0.04 degrees; at 70 degrees/s a millisecond is 0.07 more.
  EXPECT_LT(geometry::rad_to_deg(worst_pitch_rad), 0.11);
  EXPECT_EQ(run.driver().counts().telegrams_missed, 0);
  RecordProperty("worst_stamp_error_us", std::to_string(worst.count()));
  RecordProperty("worst_pitch_error_deg", std::to_string(geometry::rad_to_deg(worst_pitch_rad)));
}

INSTANTIATE_TEST_SUITE_P(
    Variants, DriversOnDevices,
    ::testing::Values(
        Case{"OneDegree",
             with(laser3d::SickVariant::k180x100, false, laser3d::SickUnit::kMillimetre),
             1e6 / 13'320.0},
        Case{"HalfDegree",
             with(laser3d::SickVariant::k180x050, false, laser3d::SickUnit::kMillimetre),
             1e6 / 13'320.0},
        Case{"Interlaced",
             with(laser3d::SickVariant::k180x050, true, laser3d::SickUnit::kCentimetre),
             1e6 / 13'320.0},
        Case{"Narrow", with(laser3d::SickVariant::k100x025, false, laser3d::SickUnit::kMillimetre),
             1e6 / 13'320.0}),
    [](const auto& tested) { return std::string(tested.param.name); });

// A wall 5 m ahead, so high and wide that a laser that looks up sees nothing else.
sim::World wall() {
  sim::World world;
  world.objects.push_back({sim::Box{{5.1, 0.0, 10.0}, {0.2, 40.0, 20.0}, 0.0}});
  return world;
}

// RMS distance of the wall's points, up to 60 degrees aside, from its surface.
double wall_rms_m(const std::vector<scan::Scan>& scans) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const scan::Scan& scan : scans) {
    for (std::size_t beam = 30; beam <= 150; ++beam, ++n) {
      const auto range_m = static_cast<double>(scan.ranges_m[beam]);
      const double off_m = scan::point_in_base(scan, beam, range_m).x() - 5.0;
      sum += off_m * off_m;
    }
  }
  return std::sqrt(sum / static_cast<double>(n));
}

std::vector<scan::Scan> scans_of_the_wall(double pitch_min_deg, double pitch_max_deg,
                                          double sweep_s) {
  laser3d::Laser3dParams params;
  params.nod.fallback.min_rad = geometry::deg_to_rad(pitch_min_deg);
  params.nod.fallback.max_rad = geometry::deg_to_rad(pitch_max_deg);
  params.nod.fallback.sweep_s = sweep_s;
  ScannerRun run(params, sim::Lms200Params{}, wall());
  run.run_until(at(15s));
  run.scans.clear();
  run.run_until(at(25s));
  return run.scans;
}

// R2: a wall seen while nodding by one degree per scan is as flat as one seen by a laser at rest,
// because each beam has its own pitch. With one pitch for the whole scan it is not: during the
// mirror's half revolution the head moves by half of that degree.
TEST(LaserOnDevice, R2_TheWallIsFlatWhileTheLaserNods) {
  const double still_m = wall_rms_m(scans_of_the_wall(35.0, 35.0, 1.0));
  std::vector<scan::Scan> scans = scans_of_the_wall(15.0, 55.0, 40.0 / 75.0);
  const double nodding_m = wall_rms_m(scans);
  for (scan::Scan& scan : scans) {
    scan.pitch_first_rad = scan.pitch_last_rad = scan.pitch_mid_rad();
  }
  const double not_interpolated_m = wall_rms_m(scans);
  // 1 cm of noise along the beams. Of that, 0.82 (35 degrees up) times 0.84 (RMS of the cosine up
  // to 60 degrees aside) is across the wall; 90 000 points.
  EXPECT_NEAR(still_m, 0.0069, 0.0003);
  EXPECT_LT(nodding_m, 1.2 * still_m);
  EXPECT_GT(not_interpolated_m, 1.2 * still_m);
  RecordProperty("still_mm", std::to_string(1e3 * still_m));
  RecordProperty("nodding_mm", std::to_string(1e3 * nodding_m));
  RecordProperty("not_interpolated_mm", std::to_string(1e3 * not_interpolated_m));
}

// R3: tolerance of half of the scanner's step of 0.25 degrees, over its whole range.
TEST(LaserOnDevice, R3_ThePitchThatIsHeldIsTheCommandedPitch) {
  for (const double pitch_deg : {-60.0, -33.3, 0.0, 12.7, 60.0}) {
    laser3d::Laser3dParams params;
    params.nod.fallback.min_rad = params.nod.fallback.max_rad = geometry::deg_to_rad(pitch_deg);
    ScannerRun run(params, sim::Lms200Params{});
    run.run_until(at(15s));
    ASSERT_FALSE(run.scans.empty());
    const scan::Scan& last = run.scans.back();
    EXPECT_NEAR(geometry::rad_to_deg(last.pitch_mid_rad()), pitch_deg, 0.125);
    EXPECT_NEAR(geometry::rad_to_deg(run.true_pitch_rad(last)), pitch_deg, 0.125);
  }
}

TEST(LaserOnDevice, AFactoryNewSensorAt9600IsConfiguredOnce) {
  sim::Lms200Params factory;
  factory.config = {0, 0, 0x46, 0, 0, 0, 1, 0, 0, 2, 2, 0, 0, 0, 0, 0, 0,
                    0, 0, 0,    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0};
  ScannerRun run(laser3d::Laser3dParams{}, factory);
  run.run_until(at(20s));
  EXPECT_EQ(run.driver().health(at(20s)).reason, "");
  EXPECT_EQ(run.driver().laser_counts().config_writes, 1);
  EXPECT_GT(run.scans.size(), 100U);
}

// The base's driver, connected to its device and driven at constant speed.
class BaseRun {
 public:
  static constexpr time::Duration kValidity = 100ms;

  explicit BaseRun(const sim::RobotModelParams& params = {}) : model_(sim::World{}, params, 1) {
    driver_.connected({});
  }

  void run_until(time::SteadyTime end, double forward_mps, double yaw_rate_rad_s = 0.0) {
    while (now_ < end) {
      now_ = std::min({device_.next_due(), next_control_, end});
      model_.advance_to(now_);
      if (const sim::Bytes bytes = cable_.read(now_); !bytes.empty()) {
        for (const kurt::OdometrySample& sample : driver_.receive(bytes, moment())) {
          samples.push_back(sample);
        }
      }
      if (now_ >= next_control_) {
        next_control_ += 10ms;
        driver_.drive({{forward_mps, yaw_rate_rad_s}, moment().wall, kValidity}, moment());
        const std::string line = driver_.control(moment());
        device_.receive(sim::Bytes(line.begin(), line.end()), cable_.baud, now_);
      }
    }
  }

  std::vector<kurt::OdometrySample> samples;
  const kurt::Kurt& driver() const { return driver_; }
  const sim::RobotModel& model() const { return model_; }

 private:
  [[nodiscard]] time::Moment moment() const {
    return {time::Timestamp(now_.time_since_epoch()), now_};
  }

  time::SteadyTime now_{};
  time::SteadyTime next_control_{};
  sim::RobotModel model_;
  kurt::Kurt driver_{kurt::KurtParams{}};
  sim::SlcanKurtBase device_{{}, model_};
  Cable cable_{device_, 1'000'000};
};

TEST(BaseOnDevice, OdometryComesEveryTenMillisecondsAndMeasuresTheDistance) {
  BaseRun run;
  run.run_until(at(10s), 0.5);
  EXPECT_NEAR(static_cast<double>(run.samples.size()), 990.0, 3.0) << "minus the adapter's start";
  // One tick of 17 um more or less in 10 ms.
  EXPECT_NEAR(run.samples.back().state.forward_mps, 0.5, 1.7e-3);
  const double distance_m =
      0.5 * (run.model().wheel_travel().left_m + run.model().wheel_travel().right_m);
  // Missing: what was driven before the driver listened, and the last period.
  EXPECT_NEAR(run.samples.back().state.T_odom_base.translation().norm(), distance_m, 0.02);
  EXPECT_EQ(run.driver().counts().encoder_lost, 0);
  EXPECT_EQ(run.driver().slcan_counts().malformed, 0);
}

// Wheels that count a tenth too much would be 23 degrees off.
TEST(BaseOnDevice, TheHeadingIsThatOfTheGyro) {
  sim::RobotModelParams params;
  params.drive.odometry_scale_bias = 0.1;
  BaseRun run(params);
  run.run_until(at(6s), 0.0);
  ASSERT_EQ(run.driver().gyro().use(), kurt::GyroUse::kUsed);
  // The bias is the simulator's 0.3 degrees per second; the random walk of 0.07 degrees is the
  // error of a second, in the mean of four windows; four times that.
  EXPECT_NEAR(geometry::rad_to_deg(*run.driver().gyro().bias_rad_s()), 0.3, 0.14);
  run.run_until(at(10s), 0.3, 1.0);
  run.run_until(at(11s), 0.0);
  const Eigen::Vector3d ahead = run.model().ground_truth().T_world_base.linear().col(0);
  const double truth_rad = std::atan2(ahead.y(), ahead.x());
  const double error_rad =
      geometry::angle_difference(run.samples.back().state.T_odom_base.yaw, truth_rad);
  // The gyro's scale is 0.5 % too large, 1.1 degrees; the rest is bias and noise, one degree at
  // three standard deviations.
  EXPECT_NEAR(geometry::rad_to_deg(error_rad), 1.1, 1.0);
  EXPECT_EQ(run.driver().gyro().counts().refused, 0);
}

}  // namespace drivers_on_devices_test
}  // namespace nodmap
