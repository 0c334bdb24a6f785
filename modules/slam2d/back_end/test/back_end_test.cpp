// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/back_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "modules/slam2d/slam2d.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace back_end_test {

using geometry::SE2;
using test::FloorPlan;
using test::Scanner;

void add_box(FloorPlan& plan, double x, double y, double width, double depth) {
  const Eigen::Vector2d a(x, y);
  const Eigen::Vector2d b(x + width, y);
  const Eigen::Vector2d c(x + width, y + depth);
  const Eigen::Vector2d d(x, y + depth);
  plan.insert(plan.end(), {{a, b}, {b, c}, {c, d}, {d, a}});
}

// A corridor 2 m wide around a block of 12 m x 8 m, with boxes along the outer wall at distances
// that do not repeat.
FloorPlan ring() {
  FloorPlan plan;
  add_box(plan, 0.0, 0.0, 12.0, 8.0);
  add_box(plan, -2.0, -2.0, 16.0, 12.0);
  for (const double x : {0.4, 1.7, 4.6, 7.1, 10.8}) {
    add_box(plan, x, -2.0, 0.5, 0.3);
    add_box(plan, x + 0.9, 9.7, 0.3, 0.3);
  }
  for (const double y : {1.1, 2.6, 6.2}) {
    add_box(plan, 13.7, y, 0.3, 0.6);
    add_box(plan, -2.0, y + 0.8, 0.3, 0.4);
  }
  return plan;
}

// Two corridors with the same boxes at the same places, 6 m apart and joined at their far ends.
FloorPlan twin_corridors() {
  FloorPlan plan;
  for (const double y : {0.0, 6.0}) {
    plan.push_back({{0, y - 1}, {30, y - 1}});
    plan.push_back({{0, y + 1}, {30, y + 1}});
    for (const double x : {3.0, 8.0, 13.0, 18.0, 23.0}) {
      add_box(plan, x, y - 1.0, 0.5, 0.2);
      add_box(plan, x + 2.0, y + 0.8, 0.5, 0.2);
    }
  }
  plan.insert(plan.end(), {{{30, -1}, {34, -1}},
                           {{34, -1}, {34, 7}},
                           {{34, 7}, {30, 7}},
                           {{30, 1}, {30, 5}},
                           {{0, -1}, {0, 1}},
                           {{0, 5}, {0, 7}}});
  return plan;
}

// A hall of 20 m x 12 m that looks the same when rotated by 180 degrees.
FloorPlan symmetric_hall() {
  FloorPlan plan;
  add_box(plan, -10.0, -6.0, 20.0, 12.0);
  add_box(plan, -6.0, -3.0, 0.6, 0.6);
  add_box(plan, 5.4, 2.4, 0.6, 0.6);
  return plan;
}

// The poses of a drive along straight lines between the places, with rotations on the spot: 0.1 m
// or 0.1 rad from scan to scan.
std::vector<SE2> drive_along(const std::vector<Eigen::Vector2d>& places) {
  std::vector<SE2> poses;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Eigen::Vector2d offset = places[i] - places[i - 1];
    const double yaw = std::atan2(offset.y(), offset.x());
    while (!poses.empty()) {
      const double rotation_rad = geometry::angle_difference(yaw, poses.back().yaw);
      if (std::abs(rotation_rad) < 1e-6) {
        break;
      }
      SE2 next = poses.back();
      next.yaw = geometry::normalize_angle(next.yaw + std::clamp(rotation_rad, -0.1, 0.1));
      poses.push_back(next);
    }
    const int steps = static_cast<int>(offset.norm() / 0.1);
    for (int step = 0; step <= steps; ++step) {
      const Eigen::Vector2d p = places[i - 1] + offset * step / steps;
      poses.push_back({p.x(), p.y(), yaw});
    }
  }
  return poses;
}

// Maps a drive with wheels that count 3 % too much distance, and a heading by odometry that drifts
// by 0.5 degrees a metre.
class Mapping {
 public:
  explicit Mapping(FloorPlan plan, const Slam2dParams& params = {})
      : plan_(std::move(plan)), slam_(params) {}

  void drive(const std::vector<SE2>& poses) {
    start_ = poses.front();
    SE2 odom;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (i > 0) {
        const SE2 step = poses[i - 1].inverse() * poses[i];
        odom = odom * SE2{1.03 * step.x, 1.03 * step.y, step.yaw + 0.009 * std::abs(step.x)};
      }
      track(slam_, scanner_.scan(plan_, poses[i], time::Timestamp(test::kPeriod * i)), odom);
      truth_.push_back(start_.inverse() * poses[i]);
    }
    slam_.finish_loops();
  }

  Slam2d& slam() { return slam_; }

  [[nodiscard]] double worst_error_m() const {
    const std::vector<SE2> trajectory = slam_.trajectory();
    double worst = 0.0;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      worst = std::max(worst, distance_m(trajectory.at(i), truth_[i]));
    }
    return worst;
  }

  [[nodiscard]] std::int64_t loops() const {
    const BackEndMetrics metrics = slam_.back_end().metrics();
    return metrics.loops_tracked + metrics.loops_searched;
  }

 private:
  FloorPlan plan_;
  Scanner scanner_;
  test::Slam slam_;
  SE2 start_;
  std::vector<SE2> truth_;
};

// One and a half times around the block: the second round lies on the first.
TEST(BackEnd, ClosesTheLoopAroundABlock) {
  Mapping mapping(ring());
  mapping.drive(drive_along({{-1, -1}, {13, -1}, {13, 9}, {-1, 9}, {-1, -1}, {13, -1}, {13, 9}}));
  EXPECT_GT(mapping.loops(), 112);             // measured: 140
  EXPECT_LT(mapping.worst_error_m(), 0.0195);  // measured: 15.9 mm
  const std::vector<SubmapLoop> loops = mapping.slam().back_end().loops();
  EXPECT_EQ(std::count_if(loops.begin(), loops.end(),
                          [](const SubmapLoop& loop) { return loop.state == LoopState::kOutlier; }),
            0);
  mapping.slam().polish();
  EXPECT_LT(mapping.worst_error_m(), 0.016);  // measured: 12.9 mm
}

// A second round makes the submaps anew, at new poses, which the page must get.
TEST(BackEnd, PolishingInRoundsIsAChangeOfTheGraph) {
  Slam2dParams params;
  params.back_end.polish.rounds = 2;
  Mapping mapping(ring(), params);
  mapping.drive(drive_along({{-1, -1}, {5, -1}}));
  const std::int64_t before = mapping.slam().back_end().graph_revision();
  mapping.slam().polish();
  EXPECT_GT(mapping.slam().back_end().graph_revision(), before);
}

TEST(BackEnd, LoopBetweenIdenticalCorridorsIsRefused) {
  Mapping mapping(twin_corridors());
  mapping.drive(drive_along({{1, 0}, {32, 0}, {32, 6}, {2, 6}}));
  mapping.slam().polish();
  EXPECT_EQ(mapping.slam().back_end().metrics().loops_searched, 0);
  EXPECT_LT(mapping.worst_error_m(), 0.061);  // measured: 49 mm; 6 m with a wrong loop
}

TEST(BackEnd, ASymmetricHallIsMappedWithoutAWrongLoop) {
  Mapping mapping(symmetric_hall());
  mapping.drive(drive_along({{-8, -4.5}, {8, -4.5}, {8, 4.5}, {-8, 4.5}, {-8, -4.5}}));
  mapping.slam().polish();
  EXPECT_LT(mapping.worst_error_m(), 0.0124);  // measured: 9.9 mm; 18 m with a wrong loop
}

// A room of 12 m x 8 m, with or without a wall in its middle.
FloorPlan room(bool has_wall) {
  FloorPlan plan;
  add_box(plan, -6.0, -4.0, 12.0, 8.0);
  add_box(plan, -6.0, 1.0, 0.4, 0.7);
  add_box(plan, -4.0, -4.0, 0.8, 0.3);
  add_box(plan, -2.5, 3.6, 0.5, 0.4);
  if (has_wall) {
    add_box(plan, 0.0, -1.5, 0.1, 3.0);
  }
  return plan;
}

// Adds keyframes; their relative poses are those in the map from which they come.
void add_all(BackEnd& back_end, std::span<const Keyframe> keyframes) {
  for (const Keyframe& keyframe : keyframes) {
    const SE2 T_submap_base = back_end.has_local()
                                  ? back_end.local().T_map_submap.inverse() * keyframe.T_map_base
                                  : SE2{};
    back_end.add_keyframe(keyframe, T_submap_base, 1e4 * Eigen::Matrix3d::Identity());
    back_end.close_loops();
    back_end.apply_loops();
  }
}

// A path through the left half of the room, along y and back, on which the robot always looks
// along x.
std::vector<SE2> path_before_wall() {
  std::vector<SE2> poses;
  for (int i = 0; i <= 60; ++i) {
    poses.push_back({-4.0, -3.0 + 0.1 * i, 0.0});
  }
  for (int i = 0; i <= 60; ++i) {
    poses.push_back({-2.2, 3.0 - 0.1 * i, 0.0});
  }
  return poses;
}

// A robot that was lost begins a new piece of map, either in the same room again or in one without
// the wall. Most of a scan fits both rooms; only the wall tells them apart.
TEST(BackEnd, LoopBetweenRoomsThatDifferByAWallIsRefused) {
  Mapping with_wall(room(true));
  with_wall.drive(path_before_wall());
  Mapping without(room(false));
  without.drive(path_before_wall());
  for (Mapping* again : {&with_wall, &without}) {
    BackEnd back_end({}, {}, {});
    add_all(back_end, with_wall.slam().keyframes());
    back_end.begin_anew({1.0, 1.0, 0.2});
    add_all(back_end, again->slam().keyframes());
    const BackEndMetrics metrics = back_end.metrics();
    EXPECT_EQ(metrics.loops_searched > 0, again == &with_wall) << metrics.loops_searched;
    EXPECT_EQ(metrics.refused_by_view > 0, again == &without) << metrics.refused_by_view;
  }
}

TEST(BackEnd, NoLoopIsClosedInAFeaturelessCorridor) {
  Mapping mapping(test::corridor());
  mapping.drive(drive_along({{0, 0}, {60, 0}}));
  EXPECT_EQ(mapping.loops(), 0);
  mapping.slam().polish();
  // The corridor is as long as odometry says, which is 3 % too much. Measured: 44 mm less than
  // that.
  EXPECT_NEAR(mapping.slam().keyframes().back().T_map_base.x, 60.0 * 1.03, 0.055);
}

// The poses of a drive `count` times around the block of ring(), from the lower left corner and
// back to it.
std::vector<SE2> rounds(int count) {
  std::vector<Eigen::Vector2d> places{{-1, -1}};
  for (int round = 0; round < count; ++round) {
    places.insert(places.end(), {{13, -1}, {13, 9}, {-1, 9}, {-1, -1}});
  }
  return drive_along(places);
}

// With further rounds the map becomes neither larger nor worse.
TEST(BackEnd, ReplacedSubmapsAreDropped) {
  Slam2dParams params;
  params.back_end.submap.max_keyframes_per_place = 4;
  Mapping three(ring(), params);
  three.drive(rounds(3));
  Mapping six(ring(), params);
  six.drive(rounds(6));
  EXPECT_GT(six.slam().back_end().metrics().submaps_dropped, 0);
  // There may be one more submap that is not replaced yet.
  EXPECT_LE(six.slam().keyframes().size(), three.slam().keyframes().size() + 20);
  EXPECT_EQ(six.slam().tracked_scans().size(), rounds(6).size());  // no pose is lost
  six.slam().polish();
  EXPECT_LT(six.worst_error_m(), 0.045);  // measured: 36 mm
}

// The remaining map is like any other: it can be saved and restored.
TEST(BackEnd, AMapWithDroppedSubmapsCanBeSavedAndRestored) {
  Slam2dParams params;
  params.back_end.submap.max_keyframes_per_place = 4;
  Mapping mapping(ring(), params);
  mapping.drive(rounds(5));
  const BackEnd& before = mapping.slam().back_end();
  ASSERT_GT(before.metrics().submaps_dropped, 0);
  BackEnd after(params.back_end, params.map, params.matcher);
  after.restore(before.save());
  EXPECT_EQ(after.submaps().size(), before.submaps().size());
  ASSERT_EQ(after.keyframes().size(), before.keyframes().size());
  for (std::size_t k = 0; k < before.keyframes().size(); ++k) {
    EXPECT_LT(distance_m(after.keyframes()[k].T_map_base, before.keyframes()[k].T_map_base), 1e-9);
  }
  after.polish();
  for (std::size_t k = 0; k < before.keyframes().size(); ++k) {
    EXPECT_LT(distance_m(after.keyframes()[k].T_map_base, before.keyframes()[k].T_map_base), 0.03);
  }
}

// A stationary robot in a crowd is lost again and again. Each time a separate submap begins, and
// none of them is ever full.
TEST(BackEnd, ARobotThatIsLostAgainAndAgainAtOnePlaceNeedsNoMoreMemory) {
  Scanner scanner;
  test::Slam slam;
  ASSERT_TRUE(track(slam, scanner.scan(test::room(), {}), {}));
  const BackEndParams params;
  BackEnd back_end(params, {}, {});
  for (int i = 0; i < 100; ++i) {
    back_end.begin_anew({3.0, 3.0, 0.5});
    back_end.add_keyframe(slam.keyframes()[0], {}, {});
    back_end.close_loops();
    back_end.apply_loops();
  }
  // The last one has just begun, and one is replaced by the newer ones.
  EXPECT_LE(back_end.submaps().size(), params.submap.max_keyframes_per_place + 2U);
  EXPECT_EQ(back_end.keyframes().size(), back_end.submaps().size());
}

// Between the rounds the submaps are rebuilt from the polished poses.
TEST(BackEnd, ASecondRoundOfPolishingIsNoWorseThanOne) {
  Slam2dParams params;
  params.back_end.polish.rounds = 2;
  Mapping mapping(ring(), params);
  mapping.drive(drive_along({{-1, -1}, {13, -1}, {13, 9}, {-1, 9}, {-1, -1}, {13, -1}, {13, 9}}));
  mapping.slam().polish();
  EXPECT_LT(mapping.worst_error_m(), 0.016);  // as after one
}

TEST(BackEnd, PolishingAnEmptyMapDoesNothing) {
  BackEnd back_end({}, {}, {});
  back_end.polish();
  EXPECT_FALSE(back_end.has_local());
  EXPECT_TRUE(back_end.keyframes().empty());
}

}  // namespace back_end_test
}  // namespace nodmap::slam2d
