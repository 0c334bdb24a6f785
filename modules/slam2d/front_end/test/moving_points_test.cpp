// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/moving_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <list>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace moving_points_test {

using geometry::SE2;

// A room of 12 m x 8 m, with its middle in the origin, and people of 40 cm x 40 cm at these
// places.
test::FloorPlan hall(const std::vector<Eigen::Vector2d>& people) {
  test::FloorPlan plan{
      {{-6, -4}, {6, -4}}, {{6, -4}, {6, 4}}, {{6, 4}, {-6, 4}}, {{-6, 4}, {-6, -4}}};
  for (const Eigen::Vector2d& p : people) {
    const Eigen::Vector2d x(0.2, 0.0);
    const Eigen::Vector2d y(0.0, 0.2);
    plan.insert(plan.end(), {{p - x - y, p + x - y},
                             {p + x - y, p + x + y},
                             {p + x + y, p - x + y},
                             {p - x + y, p - x - y}});
  }
  return plan;
}

class MovingPoints : public testing::Test {
 protected:
  // The scan that the robot takes. The origin of odom is the middle of the hall.
  LevelScan look(const std::vector<Eigen::Vector2d>& people, const SE2& T_world_base = {}) {
    points_.emplace_back();
    for (const OrientedPoint& point :
         extractor_.extract(scanner_.scan(hall(people), T_world_base), {})) {
      points_.back().push_back(point);
    }
    return {.T_odom_base = T_world_base, .points_base = points_.back()};
  }
  // The number of points of a scan within 40 cm of a place in base.
  static std::size_t near(std::span<const OrientedPoint> points, const Eigen::Vector2d& p) {
    std::size_t count = 0;
    for (const OrientedPoint& point : points) {
      count += (point.p - p).norm() < 0.4 ? 1 : 0;
    }
    return count;
  }

  test::Scanner scanner_;
  OrientedPointExtractor extractor_;
  std::list<std::vector<OrientedPoint>> points_;
  MovingPointFilter filter_;
};

TEST_F(MovingPoints, PointsOfAPersonWhoWalksIntoViewAreRemoved) {
  filter_.add_keyframe(look({{3.0, 1.0}}));
  const LevelScan later = look({{2.2, -1.0}});
  ASSERT_GT(near(later.points_base, {2.2, -1.0}), 5U);
  const auto stationary = filter_.stationary(later);
  EXPECT_EQ(near(stationary, {2.2, -1.0}), 0U);
  // All other points are kept, also those of the wall behind the person's first place, which is
  // seen for the first time.
  EXPECT_EQ(stationary.size() + near(later.points_base, {2.2, -1.0}), later.points_base.size());
}

TEST_F(MovingPoints, StationaryObjectsAreKeptWhenTheRobotMoves) {
  const std::vector<Eigen::Vector2d> people{{2.0, 1.0}, {3.5, -1.5}};
  filter_.add_keyframe(look(people));
  const SE2 motion{0.3, 0.05, 0.2};
  const LevelScan later = look(people, motion);
  EXPECT_EQ(filter_.stationary(later).size(), later.points_base.size());
}

// The person's motion since the last keyframe is less than the margin, but since the keyframe
// before that it is more.
TEST_F(MovingPoints, PointsOfASlowPersonAreRemoved) {
  filter_.add_keyframe(look({{3.0, 0.0}}));
  filter_.add_keyframe(look({{2.6, 0.0}}));
  const LevelScan later = look({{2.4, 0.0}});
  EXPECT_EQ(near(filter_.stationary(later), {2.4, 0.0}), 0U);
}

TEST_F(MovingPoints, AThinObjectBetweenTwoBeamsIsKept) {
  filter_.add_keyframe(look({}));
  LevelScan later = look({});
  points_.back()[90].p *= 0.5;  // one beam hits something at half the distance
  points_.back()[91].p *= 0.5;
  EXPECT_EQ(filter_.stationary(later).size(), later.points_base.size());
}

TEST_F(MovingPoints, AfterTheRobotIsCarriedMostPointsAreRemoved) {
  filter_.add_keyframe(look({}, {-5.0, 0.0, 0.0}));
  LevelScan later = look({}, {4.0, 0.0, 0.0});
  later.T_odom_base = {-5.0, 0.0, 0.0};  // it was carried
  EXPECT_LT(2 * filter_.stationary(later).size(), later.points_base.size());
}

TEST_F(MovingPoints, AfterTheRobotIsCarriedTheScanContradictsTheKeyframe) {
  filter_.add_keyframe(look({}, {-5.0, 0.0, 0.0}));
  LevelScan later = look({}, {4.0, 0.0, 0.0});
  EXPECT_FALSE(filter_.contradicts(later));
  later.T_odom_base = {-5.0, 0.0, 0.0};
  EXPECT_TRUE(filter_.contradicts(later));
}

TEST_F(MovingPoints, PointsInUnseenSpaceContradictNothing) {
  filter_.add_keyframe(look({{2.0, 0.0}}));
  LevelScan later = look({}, {5.0, 3.0, 2.0});
  const std::vector<OrientedPoint> few(later.points_base.begin(), later.points_base.begin() + 12);
  later.points_base = few;
  EXPECT_FALSE(filter_.contradicts(later));
  EXPECT_FALSE(MovingPointFilter().contradicts(later));
}

TEST_F(MovingPoints, WithoutAKeyframeAllPointsAreKept) {
  const LevelScan scan = look({{2.0, 0.0}});
  EXPECT_EQ(filter_.stationary(scan).size(), scan.points_base.size());
  EXPECT_TRUE(filter_.stationary({}).empty());
}

// Six people walk back and forth across a hall, in front of a robot that drives through it.
TEST(Slam2dAmongPeople, PeopleAffectNeitherThePoseNorTheMap) {
  test::Slam slam;
  test::Scanner scanner;
  SE2 truth{-4.5, -1.0, 0.0};
  const SE2 T_world_map = truth;
  SE2 odom;
  const SE2 step{0.04, 0.0, 0.006};
  double worst_m = 0.0;
  for (int i = 0; i < 180; ++i) {
    std::vector<Eigen::Vector2d> people;
    for (int person = 0; person < 6; ++person) {
      const double t = 0.2 * i;
      people.emplace_back(-3.0 + 1.6 * person, 3.3 * std::sin(0.35 * t + 1.3 * person));
    }
    const auto update =
        track(slam, scanner.scan(hall(people), truth, time::Timestamp(test::kPeriod * i)), odom);
    ASSERT_TRUE(update);
    const SE2 expected = T_world_map.inverse() * truth;
    worst_m = std::max(
        worst_m, std::hypot(update->T_map_base.x - expected.x, update->T_map_base.y - expected.y));
    truth = truth * step;
    odom = odom * SE2{1.02 * step.x, 0.0, step.yaw + 0.0003};
  }
  EXPECT_LT(worst_m, 0.01);  // the noise of a range
  // There is nothing but people inside the hall, so map points there are on people.
  std::size_t inside = 0;
  std::size_t all = 0;
  for (const Submap& submap : slam.back_end().submaps()) {
    for (const MapPoint& point : submap.points.points()) {
      const Eigen::Vector2d p = T_world_map * (submap.T_map_submap * point.point.p);
      inside += std::abs(p.x()) < 5.7 && std::abs(p.y()) < 3.7 ? 1 : 0;
      ++all;
    }
  }
  // 1.25 times what is measured.
  EXPECT_LT(static_cast<double>(inside), 0.07 * static_cast<double>(all));
}

}  // namespace moving_points_test
}  // namespace nodmap::slam2d
