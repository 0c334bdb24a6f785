// SPDX-License-Identifier: BSD-3-Clause
// Tests the purpose of the speed bound by brute force: a robot in closed loop with the nod drives
// as fast as permitted, and at every moment an obstacle appears ahead, at the protected distance or
// farther.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "modules/pitch_controller/pitch_controller.hpp"
#include "modules/pitch_controller/test/nodding_head.hpp"

namespace nodmap::pitch_controller {
namespace appearing_obstacle_test {

constexpr double kStepS = 0.005;
// KURT3D: drivers/kurt limits acceleration to 1.5 m/s2 and deceleration to 3 m/s2; the wheels lag
// by 50 ms.
constexpr double kGainMps2 = 1.5;
constexpr double kLossMps2 = 3.0;
constexpr double kLagS = 0.05;
// A robot that starts may reach an obstacle that appears nearer than the required distance of this
// speed, 0.9 m, before the laser has passed there again.
constexpr double kMinProtectedMps = 0.5;
// As high as the smallest obstacle: a box on the floor above the floor tolerance, a strip in the
// middle of the virtual corridor, and one at its top.
struct Strip {
  const char* name;
  double bottom_m;
  double top_m;
};
constexpr Strip kBox{"box", 0.05, 0.10};
constexpr Strip kStrips[] = {kBox, {"middle", 0.20, 0.25}, {"top", 0.45, 0.50}};

// A drive: the robot's position and speed every 5 ms, and the position of each scan.
struct Drive {
  struct Moment {
    double place_m;
    double speed_mps;
  };
  struct Scan {
    double time_s;
    double pitch_rad;
  };
  std::vector<Moment> moments;
  std::vector<Scan> scans;

  [[nodiscard]] const Moment& at(double time_s) const {
    const auto i = static_cast<std::size_t>(std::max(0.0, std::round(time_s / kStepS) - 1.0));
    return moments[std::min(i, moments.size() - 1)];
  }
  [[nodiscard]] double mean_mps() const {
    return moments.back().place_m / (kStepS * static_cast<double>(moments.size()));
  }
};

// What a navigator may say of its arc, honest or not: for a random time of up to a second the same,
// something else with each odometry, or nothing.
class RandomArcs {
 public:
  explicit RandomArcs(unsigned seed) : random_(seed) {}

  std::optional<ChosenArc> next(time::Timestamp now, double bound_mps) {
    if (now >= until_) {
      until_ = now + time::from_seconds(0.02 + uniform_(random_));
      kind_ = random_() % 4;
      arc_ = any();
    }
    if (kind_ == 0) {
      return std::nullopt;
    }
    ChosenArc arc = kind_ == 1 ? any() : arc_;
    arc.stamp = now;
    arc.max_forward_mps = kind_ == 3 ? bound_mps : arc.max_forward_mps;
    return arc;
  }

 private:
  ChosenArc any() {
    constexpr OnArc kDoes[] = {OnArc::kDrives, OnArc::kDrives, OnArc::kSlowed, OnArc::kElse};
    const double free_m = 4.0 * uniform_(random_);
    const double mps = 2.0 * uniform_(random_);
    const bool is_open = random_() % 4 == 0;
    return {{},
            kDoes[random_() % std::size(kDoes)],
            is_open ? std::numeric_limits<double>::infinity() : free_m,
            mps};
  }

  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  time::Timestamp until_{};
  unsigned kind_ = 0;
  ChosenArc arc_;
};

// Drives as fast as permitted, except for random stops and slower stretches.
Drive drive(const PitchControllerParams& params, unsigned seed, double seconds,
            double fastest_mps) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  RandomArcs arcs(seed);
  PitchController controller(params);
  test::NoddingHead head;
  Drive result;
  double bound_mps = 0.0;
  double command_mps = 0.0;
  double speed_mps = 0.0;
  double place_m = 0.0;
  double wanted_mps = 0.0;
  double wanted_until_s = 3.0;
  double next_scan_s = 0.0;
  PitchReading last;
  const auto take = [&](const std::optional<PitchDecision>& decision) {
    if (decision) {
      bound_mps = decision->max_forward_mps;
      head.obey(*decision);
    }
  };
  time::Timestamp now{};
  for (double t = kStepS; t < seconds; t += kStepS) {
    now += 5ms;
    if (t > wanted_until_s) {
      const double kinds[] = {0.0, 0.3, 0.6, 1.0, fastest_mps, fastest_mps, fastest_mps};
      wanted_mps = kinds[random() % std::size(kinds)];
      wanted_until_s = t + 0.15 + 3.0 * uniform(random);
    }
    const bool is_odometry = now.time_since_epoch() % 10ms == 0us;
    if (is_odometry) {
      command_mps = std::clamp(std::min(bound_mps, wanted_mps), command_mps - 0.01 * kLossMps2,
                               command_mps + 0.01 * kGainMps2);
    }
    const double before_mps = speed_mps;
    speed_mps += (command_mps - speed_mps) * (1.0 - std::exp(-kStepS / kLagS));
    place_m += 0.5 * (before_mps + speed_mps) * kStepS;
    result.moments.push_back({place_m, speed_mps});
    if (is_odometry) {
      controller.add_speed(now, speed_mps);
      if (const auto arc = arcs.next(now, bound_mps)) {
        controller.add_chosen_arc(*arc);
      }
      take(controller.decide(now));
    }
    const PitchReading before = last;
    last = head.advance_to(now);
    controller.add_pitch(last);
    take(controller.decide(now));
    for (; next_scan_s <= t; next_scan_s += params.detection.scan_period_s) {
      const double left = (t - next_scan_s) / kStepS;
      result.scans.push_back(
          {next_scan_s, last.pitch_rad + left * (before.pitch_rad - last.pitch_rad)});
    }
  }
  return result;
}

// The distance left before a strip that appears at this place and time, after the robot has braked
// as hard as it can; negative: it was hit; +infinity: the drive ends before that.
double left_before_strip_m(const Drive& drive, const PitchControllerParams& params, double time_s,
                           double strip_m, const Strip& strip) {
  const VirtualCorridor corridor = VirtualCorridor::of(params.robot);
  auto scan = std::upper_bound(drive.scans.begin(), drive.scans.end(), time_s,
                               [](double t, const Drive::Scan& s) { return t < s.time_s; });
  for (; scan != drive.scans.end(); ++scan) {
    const double ahead_m = strip_m - drive.at(scan->time_s).place_m;
    if (ahead_m <= 0.0) {
      return ahead_m;
    }
    const double height_m = corridor.axis_height_m +
                            (ahead_m + corridor.axis_behind_front_m) * std::tan(scan->pitch_rad);
    if (height_m >= strip.bottom_m && height_m <= strip.top_m) {
      const Drive::Moment braked = drive.at(scan->time_s + params.detection.processing_s);
      return strip_m - braked.place_m - braked.speed_mps * kLagS -
             braked.speed_mps * braked.speed_mps /
                 (2.0 * params.robot.braking.emergency_deceleration_mps2);
    }
  }
  return std::numeric_limits<double>::infinity();
}

// The smallest distance left, over all moments of a drive and all distances from the required
// distance on. The reaction time is two sweeps of the nod planned for the speed at that moment.
double least_left_m(const Drive& drive, const PitchControllerParams& params, const Strip& strip) {
  const SweepPlanner planner(params.robot, params.detection, params.speed.fast_mps);
  double least_m = std::numeric_limits<double>::infinity();
  for (double time_s = 4.0; time_s < kStepS * static_cast<double>(drive.moments.size());
       time_s += 2.0 * kStepS) {
    const Drive::Moment& now = drive.at(time_s);
    const double speed_mps = std::max(kMinProtectedMps, now.speed_mps);
    const double protected_m = params.robot.braking.required_distance_m(
        speed_mps, params.detection.reaction_s(planner.plan(speed_mps).sweep_s));
    for (double distance_m = protected_m; distance_m < protected_m + 1.5; distance_m += 0.05) {
      least_m = std::min(
          least_m, left_before_strip_m(drive, params, time_s, now.place_m + distance_m, strip));
    }
  }
  return least_m;
}

// In drive 104 the robot brakes to 0.5 m/s and accelerates again at once. The sweeps that were
// measured last then belong to a fast robot: with a bound that followed those, it hit a box.
TEST(AppearingObstacle, TheRobotStopsBeforeWhateverAppearsAtAnyMoment) {
  const PitchControllerParams params;
  for (const unsigned seed : {1U, 2U, 3U, 104U}) {
    const Drive driven = drive(params, seed, 60.0, 1.5);
    for (const Strip& strip : kStrips) {
      EXPECT_GT(least_left_m(driven, params, strip), 0.0) << seed << " " << strip.name;
    }
    // The robot does drive: 0.65 m/s in the slowest of these four drives.
    EXPECT_GT(driven.mean_mps(), 0.6) << seed;
  }
}

// Whatever the navigator says of its arc, also when that changes in the middle of a sweep and when
// its messages are lost.
TEST(AppearingObstacle, ANodThatFollowsThePathStopsAsWellWhateverTheNavigatorSays) {
  PitchControllerParams params;
  params.follows_path = true;
  for (const unsigned seed : {1U, 2U, 3U, 104U, 5U, 6U}) {
    const Drive driven = drive(params, seed, 60.0, 1.5);
    for (const Strip& strip : kStrips) {
      EXPECT_GT(least_left_m(driven, params, strip), 0.0) << seed << " " << strip.name;
    }
    // 0.59 m/s in the slowest of these drives.
    EXPECT_GT(driven.mean_mps(), 0.55) << seed;
  }
}

// The same test detects a robot whose lines are too coarse for the box.
TEST(AppearingObstacle, ARobotThatLooksForTallerObstaclesHitsIt) {
  PitchControllerParams careless;
  careless.detection.visible_obstacle_m = 0.2;
  const Drive driven = drive(careless, 1, 60.0, 1.5);
  EXPECT_LT(least_left_m(driven, PitchControllerParams{}, kBox), 0.0);
}

}  // namespace appearing_obstacle_test
}  // namespace nodmap::pitch_controller
