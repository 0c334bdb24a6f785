// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/sloped_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam2d/test/nodding_scanner.hpp"

namespace nodmap::slam2d {
namespace sloped_points_test {

using geometry::deg_to_rad;
using test::hall;
using test::NoddingScanner;
using test::ramp;
using test::Surfaces;

struct Outcome {
  std::vector<OrientedPoint> all;
  std::vector<OrientedPoint> kept;
};

// The level scan and the two below it, `step_deg` apart, before it in a sweep that goes up or
// after it in one that goes down. The robot drives and rotates meanwhile: `step` from scan to
// scan.
Outcome remove_slopes(const Surfaces& surfaces, double step_deg, bool goes_up,
                      const geometry::SE2& step = {}, double robot_pitch_deg = 0.0,
                      double offset_deg = 0.1, double noise_m = 0.01) {
  const std::size_t level = goes_up ? 2 : 0;
  NoddingScanner scanner(noise_m);
  std::vector<scan::Scan> scans;
  std::vector<geometry::SE2> poses;
  geometry::SE2 pose;
  for (int i = 0; i < 3; ++i) {
    const double pitch_deg = offset_deg - step_deg * std::abs(i - static_cast<int>(level));
    geometry::SE3 T_world_base = geometry::to_se3(pose);
    T_world_base.linear() =
        T_world_base.linear() *
        geometry::rotation_of({0.0, -deg_to_rad(robot_pitch_deg), 0.0});  // positive: looks up
    scans.push_back(scanner.scan(surfaces, pitch_deg, T_world_base));
    poses.push_back(pose);
    pose = pose * step;
  }
  const auto placed = [&](std::size_t i) {
    const geometry::SE2 T_level_scan = poses[level].inverse() * poses[i];
    return SweepScan{scans[i], T_level_scan, T_level_scan};
  };
  OrientedPointExtractor extractor;
  SlopedPoints sloped;
  Outcome outcome;
  const auto all = extractor.extract(scans[level], {});
  outcome.all.assign(all.begin(), all.end());
  if (!sloped.find(all, placed(level), {placed(1), placed(2 - level)})) {
    outcome.kept = outcome.all;
    return outcome;
  }
  for (std::size_t beam = 0; beam < sloped.are_on_slopes().size(); ++beam) {
    if (const OrientedPoint* const other = sloped.other_point(beam)) {
      outcome.kept.push_back(*other);
    }
  }
  return outcome;
}

// Points on the ramp of the hall: away from its walls.
std::size_t count_ahead(const std::vector<OrientedPoint>& points) {
  std::size_t count = 0;
  for (const OrientedPoint& point : points) {
    count += point.p.x() < 11.8 && std::abs(point.p.y()) < 1.9 ? 1 : 0;
  }
  return count;
}

class Slopes : public testing::TestWithParam<double> {};

// The laser is 0.38 m above the ground: a ramp of 3 degrees is met 7.3 m behind its foot.
TEST_P(Slopes, ARampIsLeftOut) {
  const double slope_deg = GetParam();
  Surfaces surfaces = hall();
  surfaces.push_back(ramp(slope_deg, 0.9));
  for (const double step_deg : {0.25, 0.5, 1.0, 1.5}) {
    for (const bool goes_up : {true, false}) {
      const Outcome outcome = remove_slopes(surfaces, step_deg, goes_up, {0.005, 0.0, 0.002});
      const std::size_t on_ramp = count_ahead(outcome.all);
      ASSERT_GT(on_ramp, 10U) << slope_deg << " degrees";
      // A few noisy points may stay, and those at the ramp's side.
      EXPECT_LE(count_ahead(outcome.kept), on_ramp / 4) << slope_deg << ' ' << step_deg;
      // Of the walls nearly all stays.
      EXPECT_GE(outcome.kept.size() + on_ramp + 6, outcome.all.size());
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Degrees, Slopes, testing::Values(3.0, 5.0, 8.0, 10.0, 12.0));

// A robot on a ramp of 10 degrees down sees the floor before it, 2.2 m ahead, as a slope.
TEST(SlopedPoints, TheFloorThatATiltedRobotLooksDownOnIsLeftOut) {
  Surfaces surfaces = hall();
  surfaces.push_back({{0, 0, 1}, 0.0});
  const Outcome outcome = remove_slopes(surfaces, 0.5, true, {}, -10.0);
  const std::size_t on_floor = count_ahead(outcome.all);
  ASSERT_GT(on_floor, 20U);
  EXPECT_LE(count_ahead(outcome.kept), on_floor / 4);
}

// All points stay.
void expect_untouched(const Surfaces& surfaces, double robot_pitch_deg = 0.0) {
  for (const double step_deg : {0.25, 0.5, 2.0}) {
    for (const bool goes_up : {true, false}) {
      // 1 m/s and 90 degrees a second.
      const geometry::SE2 step{0.013, 0.0, deg_to_rad(1.2)};
      const Outcome outcome = remove_slopes(surfaces, step_deg, goes_up, step, robot_pitch_deg);
      ASSERT_GT(outcome.all.size(), 50U);
      EXPECT_EQ(outcome.kept.size(), outcome.all.size()) << step_deg << ' ' << goes_up;
    }
  }
}

TEST(SlopedPoints, WallsStay) {
  expect_untouched(hall());
}

// Walls seen by a robot on a ramp lean by its slope.
TEST(SlopedPoints, WallsStayForATiltedRobot) {
  expect_untouched({{{1, 0, 0}, 3.0}, {{0, 1, 0}, 2.0}, {{0, 1, 0}, -2.0}}, 12.0);
  expect_untouched({{{1, 0, 0}, 1.5}, {{0, 1, 0}, 1.0}, {{0, 1, 0}, -1.0}}, -12.0);
}

// Walls that change their direction by 10 degrees.
TEST(SlopedPoints, BentWallsStay) {
  const Eigen::Vector3d bent(std::sin(deg_to_rad(10.0)), std::cos(deg_to_rad(10.0)), 0.0);
  Surfaces surfaces{{{1, 0, 0}, 12.0}, {{0, 1, 0}, -2.0}};
  surfaces.push_back({{0, 1, 0}, 2.0, [](const Eigen::Vector3d& p) { return p.x() < 4.0; }});
  surfaces.push_back({bent, bent.dot(Eigen::Vector3d(4.0, 2.0, 0.0)),
                      [](const Eigen::Vector3d& p) { return p.x() >= 4.0; }});
  expect_untouched(surfaces);
}

// Doors set back by 12 cm in the walls at both sides, and posts of 10 cm before them.
TEST(SlopedPoints, DoorsAndPostsStay) {
  Surfaces surfaces{{{1, 0, 0}, 12.0}};
  for (const double side : {1.0, -1.0}) {
    const auto is_door = [](const Eigen::Vector3d& p) {
      return std::fmod(p.x() + 20.0, 3.0) < 1.0;
    };
    surfaces.push_back(
        {{0, 1, 0}, 2.0 * side, [=](const Eigen::Vector3d& p) { return !is_door(p); }});
    surfaces.push_back({{0, 1, 0}, 2.12 * side, is_door});
    surfaces.push_back({{1, 0, 0}, 3.0, [=](const Eigen::Vector3d& p) {
                          return std::abs(p.y() - 1.2 * side) < 0.05;
                        }});
  }
  expect_untouched(surfaces);
}

// The edge of a table top 3 cm thick at the height of the laser, 0.5 m before a wall: the beams
// above it and below it meet the wall.
TEST(SlopedPoints, TableEdgesStay) {
  Surfaces surfaces = hall();
  surfaces.push_back({{1, 0, 0}, 2.5, [](const Eigen::Vector3d& p) {
                        return std::abs(p.y()) < 0.8 && std::abs(p.z() - 0.38) < 0.015;
                      }});
  surfaces.push_back(
      {{1, 0, 0}, 3.0, [](const Eigen::Vector3d& p) { return std::abs(p.y()) < 1.5; }});
  expect_untouched(surfaces);
}

TEST(SlopedPoints, ALevelLaserIsNotCompared) {
  Surfaces surfaces = hall();
  surfaces.push_back(ramp(12.0, 0.9));
  const Outcome outcome = remove_slopes(surfaces, 0.0, true);
  EXPECT_EQ(outcome.kept.size(), outcome.all.size());
}

TEST(SlopedPoints, ScansWithoutEchoesLeaveNothingOut) {
  const Outcome outcome = remove_slopes({}, 0.5, true);
  EXPECT_TRUE(outcome.all.empty());
  EXPECT_TRUE(outcome.kept.empty());
}

}  // namespace sloped_points_test
}  // namespace nodmap::slam2d
