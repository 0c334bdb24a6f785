// SPDX-License-Identifier: BSD-3-Clause
// The ground that the local map tracks, compared with profiles whose heights are known in closed
// form.
#include "modules/navigator/ground/tracked_ground.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "modules/navigator/ground/facet_finder.hpp"
#include "modules/navigator/ground/test/profile.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/local_map/test/braking_drive.hpp"

namespace nodmap::navigator {
namespace tracked_ground_test {

using geometry::deg_to_rad;
using test::NoddingRobot;
using test::Profile;

constexpr double kRangeSigmaM = 0.01;  // of the LMS200
constexpr int kTwoSweeps = 146;
constexpr double kFar = 40.0;

// What was measured while the robot drove over a profile.
struct Drive {
  double tilt_error_rad = 0.0;   // worst
  double height_error_m = 0.0;   // worst
  std::size_t points_ahead = 0;  // obstacles and holes in the way, summed over the last sweeps
  std::size_t facets = 0;
};

// The robot is stationary for two sweeps, then drives to `end_x`.
Drive drive(NoddingRobot robot, double end_x) {
  LocalMap map({}, {});
  Drive result;
  for (int i = 0; robot.x() < end_x; ++i) {
    const scan::Scan scan = robot.step(i < kTwoSweeps ? 0.0 : 0.3);
    map.add_scan(scan, robot.T_odom_base());
    const geometry::SE3 off = robot.true_pose().inverse() * map.ground().T_odom_base();
    result.tilt_error_rad = std::max(result.tilt_error_rad, geometry::rotation_angle(off));
    result.height_error_m = std::max(result.height_error_m, std::abs(off.translation().z()));
    for (const Eigen::Vector2d& p : map.points_base(robot.T_odom_base(), 0.8)) {
      result.points_ahead += i > kTwoSweeps && p.x() > 0.0 && std::abs(p.y()) < 0.3 ? 1 : 0;
    }
  }
  result.facets = map.ground().num_facets();
  return result;
}

Profile ramp_up(double slope_deg) {
  const double rise = 2.0 * std::tan(deg_to_rad(slope_deg));
  return {{{-kFar, 0.0}, {1.4, 0.0}, {3.4, rise}, {kFar, rise}}};
}

Profile hill(double slope_deg) {
  const double rise = 2.0 * std::tan(deg_to_rad(slope_deg));
  return {{{-kFar, 0.0}, {1.4, 0.0}, {3.4, rise}, {5.4, 0.0}, {kFar, 0.0}}};
}

Profile ramp_down(double slope_deg) {
  const double rise = 2.0 * std::tan(deg_to_rad(slope_deg));
  return {{{-kFar, 0.0}, {1.4, 0.0}, {3.4, -rise}, {kFar, -rise}}};
}

// Measured: errors of up to 0.053 degrees and 0.76 mm.
TEST(TrackedGround, RampsOfUpToTwelveDegreesAreGround) {
  struct Case {
    const char* name;
    Profile (*make)(double);
    std::size_t facets;
  };
  for (const Case& c : {Case{"up", ramp_up, 3}, {"over", hill, 4}, {"down", ramp_down, 3}}) {
    for (const double slope_deg : {5.0, 10.0, 12.0}) {
      const Drive result = drive({c.make(slope_deg), kRangeSigmaM}, 6.5);
      EXPECT_EQ(result.facets, c.facets) << c.name << slope_deg;
      EXPECT_LT(result.tilt_error_rad, deg_to_rad(1.25 * 0.053)) << c.name << slope_deg;
      EXPECT_LT(result.height_error_m, 1.25 * 0.00076) << c.name << slope_deg;
      EXPECT_EQ(result.points_ahead, 0U) << c.name << slope_deg;
    }
  }
}

TEST(TrackedGround, FlatFloorIsExactlyFlat) {
  const Drive result = drive({{{{-kFar, 0.0}, {kFar, 0.0}}}, kRangeSigmaM}, 3.0);
  EXPECT_EQ(result.facets, 1U);
  EXPECT_EQ(result.tilt_error_rad, 0.0);
  EXPECT_EQ(result.height_error_m, 0.0);
  EXPECT_EQ(result.points_ahead, 0U);
}

// How far a robot that drives as fast as Brake allows, but at most at `speed_mps`, remains from
// `end_x`, metres; 0 or less: it gets there.
double remains_m(const Profile& profile, double speed_mps, int seed, double end_x) {
  test::BrakingDrive drive([&](const Eigen::Vector3d& origin,
                               const Eigen::Vector3d& ray) { return profile.range_m(origin, ray); },
                           speed_mps, static_cast<std::uint32_t>(seed),
                           [&](double x) { return profile.pose_at(x); });
  return drive.until(end_x);
}

// A fast robot looks far ahead, stops about 11 cm before a ramp that it does not know, and then
// looks down as steeply as it can: at the ramp. Of the floor before that it has seen nothing. If it
// did not know the ground up to its front wheels, the ramp would begin nowhere: of 48 such robots,
// 10 would stay before a ramp down, and 5 before a ramp up.
TEST(TrackedGround, ARobotThatHasStoppedBeforeARampFindsIt) {
  for (int run = 0; run < 24; ++run) {
    std::mt19937 engine(static_cast<std::uint32_t>(run));
    const auto between = [&](double a, double b) {
      return std::uniform_real_distribution(a, b)(engine);
    };
    const double from_x = between(2.5, 4.0);
    const double rise = (run % 4 == 0 ? 2.0 : -2.0) * std::tan(deg_to_rad(between(8.0, 12.0)));
    const Profile ramp{{{-kFar, 0.0}, {from_x, 0.0}, {from_x + 2.0, rise}, {kFar, rise}}};
    EXPECT_LE(remains_m(ramp, between(0.4, 1.3), run, from_x + 0.5), 0.0) << run;
  }
}

// Two ramps meet at the bottom. Where the known ground changed from the level floor to the first
// ramp, the second one seemed to meet it in a kink from above, and was the ground where the lower
// of the two is: of 60 robots, 5 would stay on the first ramp.
TEST(TrackedGround, TwoRampsThatMeetAtTheirFeetAreDrivenOver) {
  for (int run = 0; run < 24; ++run) {
    std::mt19937 engine(static_cast<std::uint32_t>(run));
    const auto between = [&](double a, double b) {
      return std::uniform_real_distribution(a, b)(engine);
    };
    const double from_x = between(2.5, 4.0);
    const double length = between(1.2, 1.6);
    const double fall = length * std::tan(deg_to_rad(between(6.0, 12.0)));
    const Profile dip{{{-kFar, 0.0},
                       {from_x, 0.0},
                       {from_x + length, -fall},
                       {from_x + 2.0 * length, 0.0},
                       {kFar, 0.0}}};
    EXPECT_LE(remains_m(dip, between(0.4, 1.3), run, from_x + 2.0 * length + 0.5), 0.0) << run;
  }
}

// Each of these blocks the way before the robot reaches it, and does not become ground.
TEST(TrackedGround, SillsKerbsStairsAndSteepRampsBlockTheWay) {
  const double steep = std::tan(deg_to_rad(20.0));
  struct Case {
    const char* name;
    Profile profile;
  };
  for (const Case& c :
       {Case{"sill of 3.1 cm",
             {{{-kFar, 0.0}, {1.5, 0.0}, {1.5, 0.031}, {1.6, 0.031}, {1.6, 0.0}, {kFar, 0.0}}}},
        {"plank of 6 cm",
         {{{-kFar, 0.0}, {1.5, 0.0}, {1.5, 0.06}, {1.75, 0.06}, {1.75, 0.0}, {kFar, 0.0}}}},
        {"platform of 6 cm", {{{-kFar, 0.0}, {1.5, 0.0}, {1.5, 0.06}, {kFar, 0.06}}}},
        {"kerb of 8 cm up", {{{-kFar, 0.0}, {1.5, 0.0}, {1.5, 0.08}, {kFar, 0.08}}}},
        {"kerb of 8 cm down", {{{-kFar, 0.0}, {1.5, 0.0}, {1.5, -0.08}, {kFar, -0.08}}}},
        {"stairs down",
         {{{-kFar, 0.0},
           {1.5, 0.0},
           {1.5, -0.17},
           {1.8, -0.17},
           {1.8, -0.34},
           {2.1, -0.34},
           {2.1, -0.51},
           {kFar, -0.51}}}},
        {"stairs up",
         {{{-kFar, 0.0},
           {1.5, 0.0},
           {1.5, 0.17},
           {1.8, 0.17},
           {1.8, 0.34},
           {2.1, 0.34},
           {2.1, 0.51},
           {kFar, 0.51}}}},
        {"20 degrees up", {{{-kFar, 0.0}, {1.5, 0.0}, {2.5, steep}, {kFar, steep}}}},
        {"20 degrees down", {{{-kFar, 0.0}, {1.5, 0.0}, {2.5, -steep}, {kFar, -steep}}}}}) {
    // The drive ends when the body's front is 0.25 m before it.
    const Drive result = drive({c.profile, kRangeSigmaM}, 1.0);
    EXPECT_EQ(result.facets, 1U) << c.name;
    EXPECT_GT(result.points_ahead, 0U) << c.name;
  }
}

// A ramp that rises 0.2 m per metre, x from 1 to 3 and |y| < 0.5, on level ground that is known
// around it.
TrackedGround ground_with_ramp() {
  TrackedGround ground{GroundParams{}};
  ground.move({});
  PlaneFit fit;
  for (const Eigen::Vector2d& p :
       {Eigen::Vector2d(1.0, -0.5), {3.0, -0.5}, Eigen::Vector2d(1.0, 0.5), {3.0, 0.5}}) {
    fit.add({p.x(), p.y(), 0.2 * (p.x() - 1.0)});
  }
  const std::size_t ramp = ground.add_facet(fit, 0, true);
  for (double x = -0.9; x < 3.0; x += 0.1) {
    for (double y = -0.9; y < 1.0; y += 0.1) {
      ground.join({x, y}, x > 1.0 && std::abs(y) < 0.5 ? ramp : 0);
    }
  }
  return ground;
}

// A level plane.
PlaneFit level_at(double height_m) {
  PlaneFit fit;
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}}) {
    fit.add({p.x(), p.y(), height_m});
  }
  return fit;
}

// Of two facets that do not begin at each other the higher one is the ground. This holds as well
// when the facet at which one of them begins has been dropped, because there are too many.
TEST(TrackedGround, AFacetBeginsNowhereOnceTheOneBeforeItIsDropped) {
  TrackedGround ground{GroundParams{}};
  ground.move({});
  const std::size_t dropped = ground.add_facet(level_at(0.4), 0, true);
  const std::size_t low = ground.add_facet(level_at(0.1), 0, true);
  const std::size_t high = ground.add_facet(level_at(0.2), dropped, false);
  const Eigen::Vector2d p_odom(3.0, 0.0);
  ground.join(p_odom, low);
  ground.join(p_odom, high);
  ASSERT_NEAR(ground.height_m(p_odom), 0.2, 1e-9);
  const std::size_t most = 16;
  while (ground.num_facets() < most) {
    ground.add_facet(level_at(0.3), 0, true);
  }
  ground.add_facet(level_at(0.3), 0, true);
  EXPECT_EQ(ground.num_facets(), most);
  EXPECT_NEAR(ground.height_m(p_odom), 0.2, 1e-9);
}

// The rear wheels are on the floor, which is the oldest facet; the middle of the robot is on the
// ramp, 1 cm behind its kink.
TEST(TrackedGround, AFacetUnderAWheelIsNotDropped) {
  TrackedGround ground = ground_with_ramp();
  for (int cm = 0; cm <= 101; ++cm) {
    ground.move({0.01 * cm, 0.0, 0.0});
  }
  const geometry::SE3 before = ground.T_odom_base();
  const Eigen::Vector2d behind(0.6, 0.0);
  ASSERT_NEAR(ground.height_m(behind), 0.0, 1e-9);
  for (int i = 0; i < 20; ++i) {
    ground.add_facet(level_at(0.5), ground.facet_under_base(), true);
  }
  EXPECT_NEAR(ground.height_m(behind), 0.0, 1e-9);
  ground.move({1.01, 0.0, 0.0});
  EXPECT_TRUE(ground.T_odom_base().isApprox(before, 1e-9));
}

// In closed form: the front wheels are 0.1 m up the ramp, so 2 cm high, and the wheelbase is 0.3 m.
TEST(TrackedGround, TheBodysTiltFollowsFromTheHeightsOfItsWheels) {
  TrackedGround ground = ground_with_ramp();
  for (int cm = 0; cm <= 95; ++cm) {
    ground.move({0.01 * cm, 0.0, 0.0});
  }
  const double front_m = 0.2 * 0.1;
  EXPECT_NEAR(ground.T_odom_base().translation().z(), 0.5 * front_m, 1e-9);
  const Eigen::Vector3d forward = ground.T_odom_base().linear().col(0);
  EXPECT_NEAR(forward.z() / forward.x(), front_m / 0.3, 1e-9);
  // Across the slope the body rolls: its left side, which is downhill, is lower.
  for (int cm = 95; cm <= 200; ++cm) {
    ground.move({0.01 * cm, 0.0, 0.0});
  }
  for (int step = 0; step <= 10; ++step) {
    ground.move({2.0, 0.0, 0.05 * step * geometry::kPi});
  }
  const Eigen::Vector3d left = ground.T_odom_base().linear().col(1);
  EXPECT_NEAR(left.z() / left.head<2>().norm(), -0.2, 1e-9);
  EXPECT_NEAR(ground.T_odom_base().linear().col(0).z(), 0.0, 1e-9);
}

// Seen from the floor, the floor beside the ramp is ground and the ramp's side is an obstacle. Seen
// from the ramp, 0.2 m up, both are a drop.
TEST(TrackedGround, TheSideOfARampIsAnObstacleFromBelowAndADropFromAbove) {
  using Kind = TrackedGround::Place::Kind;
  TrackedGround ground = ground_with_ramp();
  const Eigen::Vector3d floor(2.0, 0.6, 0.0);
  const Eigen::Vector3d side(2.0, 0.5, 0.1);
  EXPECT_EQ(ground.look(floor, 0.02).kind, Kind::kGround);
  EXPECT_EQ(ground.look(side, 0.02).kind, Kind::kAbove);
  for (int cm = 0; cm <= 200; ++cm) {
    ground.move({0.01 * cm, 0.0, 0.0});
  }
  EXPECT_EQ(ground.look(floor, 0.02).kind, Kind::kBelow);
  EXPECT_EQ(ground.look(side, 0.02).kind, Kind::kBelow);
  EXPECT_EQ(ground.look({2.0, 0.0, 0.2}, 0.02).kind, Kind::kGround);
}

// The ramp falls 0.2 m per metre, x from 0 to 1, to level ground. Below that ground, where the ramp
// would go on, there is a hole.
TEST(TrackedGround, SeenFromARampAHoleBehindItsFootIsNotTheRamp) {
  using Kind = TrackedGround::Place::Kind;
  TrackedGround ground{GroundParams{}};
  ground.move({-0.5, 0.0, 0.0});
  PlaneFit fit;
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}}) {
    fit.add({p.x(), p.y(), -0.2 * p.x()});
  }
  const std::size_t ramp = ground.add_facet(fit, 0, false);
  const std::size_t level = ground.add_facet(level_at(-0.2), ramp, true);
  for (double x = 0.1; x < 2.0; x += 0.1) {
    ground.join({x, 0.0}, x < 1.0 ? ramp : level);
  }
  for (int cm = -50; cm <= 60; ++cm) {
    ground.move({0.01 * cm, 0.0, 0.0});
  }
  ASSERT_EQ(ground.facet_under_base(), ramp);
  constexpr double kToleranceM = 0.03;
  EXPECT_EQ(ground.look({1.3, 0.0, -0.2}, kToleranceM).kind, Kind::kGround);
  EXPECT_EQ(ground.look({1.3, 0.0, -0.26}, kToleranceM).kind, Kind::kBelow);
  EXPECT_EQ(ground.look({1.3, 0.0, -0.24}, kToleranceM).kind, Kind::kBelow);
}

// Beside the last number before the strip's left edge there is no room for rounding.
TEST(FacetFinder, APointAtTheVeryEdgeOfTheStripIsInItsLastColumn) {
  const Eigen::Vector2d p_base(1.0, std::nextafter(0.35, 0.0));
  TrackedGround ground{GroundParams{}};
  ground.move({});
  FacetFinder finder{LocalMapParams{}};
  for (int i = 0; i < 10; ++i) {
    finder.add({p_base.x(), p_base.y(), 0.0}, p_base);
  }
  finder.end_scan(ground, {});
  EXPECT_EQ(ground.num_facets(), 1U);
}

TEST(PlaneFit, IsExactOnAPlaneAndEmptyOnALine) {
  PlaneFit fit;
  for (const Eigen::Vector2d& p :
       {Eigen::Vector2d(5.0, 1.0), {5.4, 1.0}, Eigen::Vector2d(5.0, 1.3), {5.4, 1.3}}) {
    fit.add({p.x(), p.y(), 0.1 * p.x() - 0.2 * p.y() + 3.0});
  }
  const auto plane = fit.solve();
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->at({7.0, -2.0}), 0.7 + 0.4 + 3.0, 1e-9);
  EXPECT_NEAR(fit.level().at({7.0, -2.0}), 0.52 - 0.23 + 3.0, 1e-9);
  PlaneFit line;
  for (double x = 0.0; x < 1.0; x += 0.1) {
    line.add({x, 2.0 * x, 0.5});
  }
  EXPECT_FALSE(line.solve());
}

TEST(TrackedGround, SurvivesPosesThatMakeNoSense) {
  TrackedGround ground{GroundParams{}};
  ground.move({1e12, -1e12, 1.0});
  EXPECT_TRUE(ground.is_level());
  EXPECT_EQ(ground.height_m({5.0, 5.0}), 0.0);
}

}  // namespace tracked_ground_test
}  // namespace nodmap::navigator
