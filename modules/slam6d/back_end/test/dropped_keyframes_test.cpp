// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/dropped_keyframes.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::slam6d {
namespace dropped_keyframes_test {

using geometry::SE3;

SE3 at(double x, double y = 0.0) {
  SE3 T = SE3::Identity();
  T.translation() = Eigen::Vector3d(x, y, 0.0);
  return T;
}

// Ten sweeps go from 0 to 4 m and back again; those at even metres are keyframes.
struct Drive {
  CorrectedPoses poses;
  std::vector<Keyframe> keyframes;
  std::vector<IntermediateSweep> between;
  DroppedKeyframes dropped;

  Drive() {
    const std::vector<SE3> T_map_sweeps{at(0.0), at(1.0), at(2.0), at(3.0), at(4.0),
                                        at(3.0), at(2.0), at(1.0), at(0.0), at(-1.0)};
    for (std::size_t i = 0; i < T_map_sweeps.size(); ++i) {
      poses.add({.T_map_base = T_map_sweeps[i]});
      if (i % 2 == 0) {
        keyframes.push_back({.id = i / 2,
                             .sweep = i,
                             .T_map_base = T_map_sweeps[i],
                             .cloud = nullptr,
                             .points = {}});
      } else {
        between.push_back({i, {}});
      }
    }
  }
};

TEST(DroppedKeyframes, TheSweepMovesWithTheKeyframeThatReplacesIt) {
  Drive drive;
  drive.dropped.drop({.index = 1, .by = 3}, false, drive.poses, drive.keyframes, drive.between);
  ASSERT_EQ(drive.keyframes.size(), 4U);
  EXPECT_EQ(drive.keyframes[1].sweep, 4U);
  // The keyframe at 2 m of the way back is number 2 by now. It alone moves.
  std::vector<SE3> moved;
  for (const Keyframe& keyframe : drive.keyframes) {
    moved.push_back(keyframe.T_map_base);
  }
  moved[2] = at(2.0, 0.3);
  const auto corrections = drive.dropped.corrections(drive.keyframes, moved, drive.poses);
  ASSERT_EQ(corrections.size(), 1U);
  EXPECT_EQ(corrections[0].sweep, 2U);
  EXPECT_TRUE(corrections[0].T_map_base.isApprox(at(2.0, 0.3), 1e-12));
}

// Sweep 3 follows the dropped keyframe, sweep 2.
TEST(DroppedKeyframes, TheSweepsInBetweenAreDroppedToo) {
  Drive drive;
  drive.between.push_back({6, {}});  // at the place of the keyframe
  drive.dropped.drop({.index = 1, .by = 3}, false, drive.poses, drive.keyframes, drive.between);
  std::vector<std::size_t> left;
  for (const IntermediateSweep& sweep : drive.between) {
    left.push_back(sweep.sweep);
  }
  EXPECT_EQ(left, (std::vector<std::size_t>{1, 5, 7, 9}));
}

// A dropped sweep whose keyframe is dropped later follows that one's replacement.
TEST(DroppedKeyframes, ReplacementsAreReplaced) {
  Drive drive;
  drive.dropped.drop({.index = 1, .by = 3}, false, drive.poses, drive.keyframes, drive.between);
  drive.dropped.drop({.index = 2, .by = 3}, false, drive.poses, drive.keyframes, drive.between);
  const std::vector<SE3> moved{at(0.0), at(4.0), at(0.0, 0.5)};
  const auto corrections = drive.dropped.corrections(drive.keyframes, moved, drive.poses);
  ASSERT_EQ(corrections.size(), 2U);
  EXPECT_TRUE(corrections[0].T_map_base.isApprox(at(2.0, 0.5), 1e-12));
  EXPECT_TRUE(corrections[1].T_map_base.isApprox(at(2.0, 0.5), 1e-12));
}

// The path has been thinned out, and keeps the sweep no longer.
TEST(DroppedKeyframes, ASweepThatIsNotKeptIsForgotten) {
  Drive drive;
  drive.dropped.drop({.index = 1, .by = 3}, false, drive.poses, drive.keyframes, drive.between);
  const std::vector<SE3> moved(4, at(0.0));
  drive.dropped.forget_sweeps_not_in(drive.poses);
  EXPECT_EQ(drive.dropped.corrections(drive.keyframes, moved, drive.poses).size(), 1U);
  drive.dropped.forget_sweeps_not_in(CorrectedPoses());
  EXPECT_TRUE(drive.dropped.corrections(drive.keyframes, moved, drive.poses).empty());
}

TEST(DroppedKeyframes, AKeyframeOfASavedMapLeavesNoSweep) {
  Drive drive;
  drive.dropped.drop({.index = 1, .by = 3}, true, drive.poses, drive.keyframes, drive.between);
  const std::vector<SE3> moved(4, at(0.0));
  EXPECT_TRUE(drive.dropped.corrections(drive.keyframes, moved, drive.poses).empty());
}

}  // namespace dropped_keyframes_test
}  // namespace nodmap::slam6d
