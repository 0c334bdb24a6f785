// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace slip_detector_test {

using geometry::SE2;
using test::Scanner;
using test::track;

constexpr time::Duration kSlow = 600ms;  // as a nodding laser measures level scans

// A hall of 14 m x 5 m: its long walls hold a pose back along neither.
test::FloorPlan hall() {
  return {{{-2, -2.5}, {12, -2.5}}, {{12, -2.5}, {12, 2.5}}, {{12, 2.5}, {-2, 2.5}}};
}

// What the robot does from one scan to the next, and what its wheels count.
struct Step {
  SE2 truth;
  SE2 odometry;
};

struct Outcome {
  std::vector<PoseUpdate> updates;
  double worst_tracked_m = 0.0;  // the largest error of a pose that is TRACKING
  double end_m = 0.0;            // the error of the last pose
  std::size_t num_map_points = 0;
};

// Drives; `somebody`: walls in base that move along with the robot.
Outcome drive(const test::FloorPlan& plan, const std::vector<Step>& steps,
              const test::FloorPlan& somebody = {}) {
  test::Slam slam;
  Scanner scanner;
  SE2 truth;
  SE2 odom;
  Outcome outcome;
  time::Timestamp stamp{1s};
  for (const Step& step : steps) {
    truth = truth * step.truth;
    slam.input.add_odometry(stamp - kSlow / 2, geometry::to_se3(odom));
    odom = odom * step.odometry;
    test::FloorPlan seen = plan;
    for (const test::Wall& wall : somebody) {
      seen.push_back({truth * wall.from, truth * wall.to});
    }
    const auto update = track(slam, scanner.scan(seen, truth, stamp), odom);
    EXPECT_TRUE(update);
    stamp += kSlow;
    outcome.updates.push_back(update.value_or(PoseUpdate{}));
    outcome.end_m = distance_m(outcome.updates.back().T_map_base, truth);
    if (outcome.updates.back().state == PoseState::kTracking) {
      outcome.worst_tracked_m = std::max(outcome.worst_tracked_m, outcome.end_m);
    }
  }
  outcome.num_map_points = slam.back_end().num_points();
  return outcome;
}

const SE2 kAhead{0.4, 0.0, 0.0};

std::vector<Step> ahead(std::size_t num_steps) {
  return std::vector<Step>(num_steps, {kAhead, kAhead});
}

std::vector<Step> with_slip(const std::vector<Step>& slip) {
  std::vector<Step> steps = ahead(8);
  steps.insert(steps.end(), slip.begin(), slip.end());
  const std::vector<Step> rest = ahead(5);
  steps.insert(steps.end(), rest.begin(), rest.end());
  return steps;
}

TEST(SlipDetector, WheelsThatSlipInAHallDoNotTakeThePoseAlong) {
  const std::vector<std::pair<const char*, std::vector<Step>>> slips{
      {"the wheels count 1.9 m, the robot is stationary",
       {{{}, {0.6, 0.0, 0.0}}, {{}, {0.3, 0.0, 0.0}}, {{}, {1.0, 0.0, 0.0}}}},
      {"backwards", {{{}, {-0.7, 0.0, 0.0}}, {{}, {-0.7, 0.0, 0.0}}}},
      {"half", {{{0.35, 0.0, 0.0}, {0.7, 0.0, 0.0}}, {{0.35, 0.0, 0.0}, {0.7, 0.0, 0.0}}}},
      {"after a part of the way", {{{0.2, 0.0, 0.0}, {0.9, 0.0, 0.0}}}},
      {"along an arc", {{{}, {0.6, 0.1, 0.4}}, {{}, {0.6, 0.1, 0.4}}}},
  };
  for (const auto& [name, slip] : slips) {
    const Outcome outcome = drive(hall(), with_slip(slip));
    // The scan noise of 1 cm, twice.
    EXPECT_LT(outcome.worst_tracked_m, 0.02) << name;
    EXPECT_LT(outcome.end_m, 0.02) << name;
    EXPECT_EQ(outcome.updates.back().state, PoseState::kTracking) << name;
  }
}

// Somebody who walks ahead keeps his place relative to the robot, as if it did not move. In a bare
// corridor nothing else tells the place along it.
TEST(SlipDetector, PeopleWhoWalkAheadInABareCorridorDoNotHoldThePoseBack) {
  const test::FloorPlan one{{{1.0, -0.3}, {1.0, 0.2}}, {{1.0, 0.2}, {1.3, 0.25}}};
  const test::FloorPlan two{{{1.5, -0.8}, {1.5, -0.1}}, {{1.6, 0.1}, {1.6, 0.8}}};
  for (const test::FloorPlan& people : {one, two}) {
    const Outcome outcome = drive(test::corridor(), ahead(20), people);
    EXPECT_LT(outcome.end_m, 0.02);  // odometry has no error
    for (const PoseUpdate& update : outcome.updates) {
      EXPECT_TRUE(update.is_matched());
    }
  }
}

// The wall at the end of a corridor is no longer than people abreast are, but it was seen from
// farther back as well.
TEST(SlipDetector, SlipBeforeTheEndOfANarrowCorridorIsFound) {
  const test::FloorPlan narrow{
      {{-9, -0.9}, {6, -0.9}}, {{6, -0.9}, {6, 0.9}}, {{6, 0.9}, {-9, 0.9}}};
  const SE2 counted{0.9, 0.0, 0.0};
  const Outcome outcome = drive(narrow, with_slip({{{}, counted}, {{}, counted}}));
  EXPECT_LT(outcome.end_m, 0.02);  // the scan noise, twice
  EXPECT_LT(outcome.worst_tracked_m, 0.02);
}

// The keyframes of a robot that slips do not draw the walls anew.
TEST(SlipDetector, SlipDoesNotEnterTheMap) {
  const SE2 counted{0.7, 0.0, 0.0};
  const Outcome slipping = drive(hall(), with_slip({{{}, counted}, {{}, counted}}));
  const Outcome stationary = drive(hall(), with_slip({{}, {}}));
  // A wall drawn twice would add 100 points.
  EXPECT_LT(slipping.num_map_points, stationary.num_map_points + 20);
}

}  // namespace slip_detector_test
}  // namespace nodmap::slam2d
