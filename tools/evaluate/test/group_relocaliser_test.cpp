// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/group_relocaliser.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::evaluate {
namespace group_relocaliser_test {

namespace test = slam2d::test;
using geometry::SE2;
using slam2d::KnownMap;
using slam2d::LevelScan;
using slam2d::Relocalisation;
using Status = Relocalisation::Status;

class GroupRelocaliserTest : public testing::Test {
 protected:
  Relocalisation locate(const KnownMap& map, const test::FloorPlan& plan, const SE2& truth) {
    return locate_group(map, plan, {{truth, truth}});
  }

  struct TakenAt {
    SE2 truth;
    SE2 T_odom_base;
  };
  Relocalisation locate_group(const KnownMap& map, const test::FloorPlan& plan,
                              const std::vector<TakenAt>& taken) {
    std::vector<std::vector<slam2d::OrientedPoint>> points;
    std::vector<LevelScan> scans;
    for (const TakenAt& at : taken) {
      const auto seen = extractor_.extract(scanner_.scan(plan, at.truth), {});
      points.emplace_back(seen.begin(), seen.end());
      scans.push_back({.T_odom_base = at.T_odom_base, .points_base = points.back()});
    }
    return GroupRelocaliser({}, {}).locate(map, scans);
  }

  test::Scanner scanner_;
  slam2d::OrientedPointExtractor extractor_;
};

TEST_F(GroupRelocaliserTest, AGroupOfOneScanGivesTheSameResultAsTheScan) {
  const KnownMap map(slam2d::trinary(test::drawn_grid(test::room(), test::poses_in_room())), {});
  const auto points = extractor_.extract(scanner_.scan(test::room(), {-1.0, 0.5, 0.3}), {});
  const LevelScan scan{.T_odom_base = {}, .points_base = points};
  const Relocalisation alone = slam2d::Relocaliser({}, {}).locate(map, scan);
  const Relocalisation group = GroupRelocaliser({}, {}).locate(map, {&scan, 1});
  EXPECT_EQ(alone.status, Status::kFound);
  EXPECT_EQ(alone.status, group.status);
  EXPECT_EQ(alone.T_map_base.x, group.T_map_base.x);
  EXPECT_EQ(alone.score, group.score);
  EXPECT_EQ(alone.runner_up_score, group.runner_up_score);
}

// Three rooms that differ only by two screens. The first room has one on the right and one on the
// left, the second has only the right one, and the third only the left one.
class LookAlikeRooms : public GroupRelocaliserTest {
 protected:
  LookAlikeRooms() {
    std::vector<SE2> poses;
    for (const int i : {0, 1, 2}) {
      test::FloorPlan plan = test::room();
      if (i != 2) {
        plan.push_back({{1.2, -1.6}, {1.2, 0.0}});
      }
      if (i != 1) {
        plan.push_back({{-1.6, 0.6}, {-1.6, 2.2}});
      }
      for (const test::Wall& wall : plan) {
        const Eigen::Vector2d offset(20.0 * i, 0.0);
        plan_.push_back({wall.from + offset, wall.to + offset});
      }
      for (const SE2& pose : test::poses_in_room()) {
        poses.push_back({pose.x + 20.0 * i, pose.y, pose.yaw});
        poses.push_back({pose.x + 20.0 * i, 0.5, pose.yaw});
      }
    }
    map_.emplace(slam2d::trinary(test::drawn_grid(plan_, poses)), slam2d::MapParams{});
  }

  const SE2 right_{-0.3, 0.3, 0.0};
  const SE2 left_{-0.2, 0.4, 3.1};
  test::FloorPlan plan_;
  std::optional<KnownMap> map_;
};

TEST_F(LookAlikeRooms, SeveralScansFindAPlaceThatNoneOfThemFindsAlone) {
  for (const SE2& truth : {right_, left_}) {
    EXPECT_EQ(locate(*map_, plan_, truth).status, Status::kAmbiguous);
  }
  const SE2 T_odom_map{7.0, -3.0, 1.0};
  const SE2 between{-0.25, 0.35, 1.5};
  const Relocalisation found = locate_group(*map_, plan_,
                                            {{right_, T_odom_map * right_},
                                             {between, T_odom_map * between},
                                             {left_, T_odom_map * left_}});
  EXPECT_EQ(found.status, Status::kFound);
  EXPECT_NEAR(found.T_map_base.x, left_.x, 0.05);  // cells of 5 cm
  EXPECT_NEAR(found.T_map_base.y, left_.y, 0.05);
  EXPECT_NEAR(geometry::angle_difference(found.T_map_base.yaw, left_.yaw), 0.0, 0.03);
}

TEST_F(GroupRelocaliserTest, OdometryThatLagsInARotationDoesNotMatter) {
  const KnownMap map(slam2d::trinary(test::drawn_grid(test::room(), test::poses_in_room())), {});
  const SE2 first{-1.0, 0.5, 0.3};
  const SE2 last{-0.8, 0.5, 0.6};
  const Relocalisation found =
      locate_group(map, test::room(), {{first, first}, {last, {last.x, last.y, last.yaw - 0.25}}});
  EXPECT_EQ(found.status, Status::kFound);
  EXPECT_NEAR(found.T_map_base.x, last.x, 0.05);
  EXPECT_NEAR(found.T_map_base.y, last.y, 0.05);
  EXPECT_NEAR(found.T_map_base.yaw, last.yaw, 0.03);
}

// Each scan alone is found at its place, but odometry says that the robot did not move from one
// place to the other.
TEST_F(GroupRelocaliserTest, ScansThatContradictEachOtherFindNothing) {
  const KnownMap map(slam2d::trinary(test::drawn_grid(test::room(), test::poses_in_room())), {});
  const SE2 first{-1.0, 0.5, 0.3};
  const SE2 carried{-0.2, 0.0, -0.4};
  for (const SE2& truth : {first, carried}) {
    EXPECT_EQ(locate(map, test::room(), truth).status, Status::kFound);
  }
  EXPECT_EQ(locate_group(map, test::room(), {{first, {}}, {carried, {}}}).status, Status::kNowhere);
}

}  // namespace group_relocaliser_test
}  // namespace nodmap::evaluate
