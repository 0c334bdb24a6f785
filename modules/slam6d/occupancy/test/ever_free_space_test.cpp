// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/ever_free_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace ever_free_space_test {

using geometry::SE3;

constexpr int kSweepsPerKeyframe = 4;

// A person beside the robot's path, as tall as a child.
constexpr float kHeightM = 1.2F;
// Points of a person count only above this height, one and a half voxels above the floor: farther
// down, noise of the floor reaches their voxels.
constexpr float kLowestM = 0.11F;

Room hall_with_somebody() {
  Room room = Room::hall();
  room.boxes = {
      {Eigen::Vector3d(1.4, 0.3, 0.0), Eigen::Vector3d(1.8, 0.7, static_cast<double>(kHeightM))}};
  return room;
}

bool is_of_somebody(const Eigen::Vector3f& p_map) {
  return p_map.x() > 1.35F && p_map.x() < 1.85F && p_map.y() > 0.25F && p_map.y() < 0.75F &&
         p_map.z() > kLowestM && p_map.z() < kHeightM + 0.05F;
}

// A drive along the hall, with four sweeps for each keyframe. A person is there from the sweep
// `with_somebody.first` to before the sweep `with_somebody.second`.
struct Drive {
  explicit Drive(std::pair<int, int> with_somebody) {
    int i = 0;
    for (const SE3& T_keyframe : along_hall()) {
      for (int part = 0; part < kSweepsPerKeyframe; ++part, ++i) {
        const SE3 T_map_base = T_keyframe * pose(0.25 * part, 0.0, 0.0);
        const bool is_there = i >= with_somebody.first && i < with_somebody.second;
        const SweepCloud cloud = cloud_at(is_there ? hall_with_somebody() : Room::hall(),
                                          T_map_base, static_cast<unsigned>(i));
        if (part == 0) {
          T_map_keyframes.push_back(T_map_base);
          keyframes.push_back(cloud);
        }
        space.add_sweep(cloud, T_map_base, keyframes.size() - 1);
      }
    }
  }

  // The fractions of a keyframe's points that count as moved: of the points on the person, and of
  // all others.
  struct Shares {
    double of_somebody = 0.0;
    double of_others = 0.0;
  };
  [[nodiscard]] Shares moved_of(std::size_t k) const {
    const std::vector<bool> is_moved = space.moved_points(keyframes[k], k);
    std::array<double, 2> moved{};
    std::array<double, 2> all{};
    for (std::size_t i = 0; i < is_moved.size(); ++i) {
      const Eigen::Vector3f p_map =
          (T_map_keyframes[k] * keyframes[k].points[i].cast<double>()).cast<float>();
      const std::size_t whose = is_of_somebody(p_map) ? 0 : 1;
      all[whose] += 1.0;
      moved[whose] += is_moved[i] ? 1.0 : 0.0;
    }
    return {moved[0] / std::max(all[0], 1.0), moved[1] / all[1]};
  }

  EverFreeSpace space{EverFreeParams{}};
  std::vector<SE3> T_map_keyframes;
  std::vector<SweepCloud> keyframes;
};

constexpr std::size_t kVisited = 2;  // the keyframe that sees the person
constexpr std::pair kWalksBy{kSweepsPerKeyframe * 2, kSweepsPerKeyframe * 2 + 2};

// Target: 95 % of the points that moved are removed, and 99.5 % of all others are kept.
TEST(EverFreeSpace, PointsOfAPassingPersonCountAsMovedAndThoseOfWallsDoNot) {
  const Drive drive(kWalksBy);
  EXPECT_GT(drive.moved_of(kVisited).of_somebody, 0.95);
  for (std::size_t k = 0; k < drive.keyframes.size(); ++k) {
    EXPECT_LT(drive.moved_of(k).of_others, 0.005) << k;
  }
}

// The floor lies in the middle of a layer of voxels, so that only feet are in the next layer. All
// points from 11 cm above the floor on are removed, not only those from 14 cm on.
TEST(EverFreeSpace, FeetCountAsMoved) {
  const Drive drive(kWalksBy);
  const std::vector<bool> is_moved = drive.space.moved_points(drive.keyframes[kVisited], kVisited);
  int feet = 0;
  int moved = 0;
  for (std::size_t i = 0; i < is_moved.size(); ++i) {
    const Eigen::Vector3f p_map =
        (drive.T_map_keyframes[kVisited] * drive.keyframes[kVisited].points[i].cast<double>())
            .cast<float>();
    if (is_of_somebody(p_map) && p_map.z() < 0.135F) {
      ++feet;
      moved += is_moved[i] ? 1 : 0;
    }
  }
  ASSERT_GT(feet, 3);
  EXPECT_GT(moved, 0.9 * feet);
}

// The other sweeps look up by at most 8 degrees, which is below the person's head. No beam passes
// through the place of the head, but it is removed along with the rest of the person.
TEST(EverFreeSpace, PartsOfAPersonThatNoBeamHasPassedCountAsMoved) {
  EverFreeSpace space{EverFreeParams{}};
  const SE3 T_map_base = pose(-0.5, 0.0, 0.0);
  const SweepCloud visited = cloud_at(hall_with_somebody(), T_map_base, 1);
  space.add_sweep(visited, T_map_base, 0);
  const float highest = std::tan(static_cast<float>(geometry::deg_to_rad(8.0)));
  for (unsigned i = 0; i < 10; ++i) {
    const SE3 T_map_next = pose(-0.4 + 0.08 * i, 0.0, 0.0);
    SweepCloud low = cloud_at(Room::hall(), T_map_next, 2 + i);
    std::erase_if(low.points, [highest](const Eigen::Vector3f& p) {
      return p.z() - 0.4F > highest * p.head<2>().norm();
    });
    low.lines.front().end = low.points.size();
    space.add_sweep(low, T_map_next, 0);
  }
  const std::vector<bool> is_moved = space.moved_points(visited, 0);
  // The height above which the other sweeps have no beams at the person, who is at most 2.3 m away.
  const float seen_to_m = 0.4F + 2.3F * highest;
  int heads = 0;
  int moved = 0;
  for (std::size_t i = 0; i < is_moved.size(); ++i) {
    const Eigen::Vector3f p_map = (T_map_base * visited.points[i].cast<double>()).cast<float>();
    if (is_of_somebody(p_map) && p_map.z() > seen_to_m && p_map.z() < seen_to_m + 0.1F) {
      ++heads;
      moved += is_moved[i] ? 1 : 0;
    }
  }
  ASSERT_GT(heads, 3);
  EXPECT_GT(moved, heads / 2);
}

TEST(EverFreeSpace, ObjectsThatAllSweepsSeeDoNotCountAsMoved) {
  const Drive drive({0, 1000});
  for (std::size_t k = 0; k < drive.keyframes.size(); ++k) {
    EXPECT_LT(drive.moved_of(k).of_somebody, 0.005) << k;
    EXPECT_LT(drive.moved_of(k).of_others, 0.005) << k;
  }
}

// A person who is there for half of the drive cannot be distinguished from furniture that was
// carried away.
TEST(EverFreeSpace, APersonWhoStandsLongDoesNotCountAsMoved) {
  const Drive drive({0, 14});
  EXPECT_LT(drive.moved_of(kVisited).of_somebody, 0.25);
}

// A loop closure moves all keyframes by 1 m and 30 degrees.
TEST(EverFreeSpace, VotesMoveWithTheirKeyframes) {
  Drive drive(kWalksBy);
  const SE3 T_new_old = pose(1.0, 0.3, 30.0);
  std::vector<SE3> T_new_keyframes;
  for (const SE3& T_map_base : drive.T_map_keyframes) {
    T_new_keyframes.push_back(T_new_old * T_map_base);
  }
  drive.space.move_keyframes(T_new_keyframes);
  // Votes are rounded by half a voxel, so that some points near the floor no longer count as moved.
  EXPECT_GT(drive.moved_of(kVisited).of_somebody, 0.8);
  for (std::size_t k = 0; k < drive.keyframes.size(); ++k) {
    EXPECT_LT(drive.moved_of(k).of_others, 0.005) << k;
  }
}

// A keyframe is dropped: the votes still move with those that are left.
TEST(EverFreeSpace, VotesOfADroppedKeyframeGoToTheOneThatReplacesIt) {
  Drive drive(kWalksBy);
  drive.space.drop_keyframe({.index = kVisited - 1, .by = kVisited});
  drive.T_map_keyframes.erase(drive.T_map_keyframes.begin() + kVisited - 1);
  drive.keyframes.erase(drive.keyframes.begin() + kVisited - 1);
  std::vector<SE3> T_new_keyframes;
  for (const SE3& T_map_base : drive.T_map_keyframes) {
    T_new_keyframes.push_back(pose(1.0, 0.3, 30.0) * T_map_base);
  }
  drive.space.move_keyframes(T_new_keyframes);
  EXPECT_GT(drive.moved_of(kVisited - 1).of_somebody, 0.8);
  for (std::size_t k = 0; k < drive.keyframes.size(); ++k) {
    EXPECT_LT(drive.moved_of(k).of_others, 0.005) << k;
  }
}

// A loop is closed, and a keyframe dropped, before enough sweeps have voted: those that wait then
// vote from where they are by now, as if they had been measured there.
TEST(EverFreeSpace, SweepsThatWaitMoveWithTheirKeyframes) {
  const SE3 T_new_old = pose(1.0, 0.3, 30.0);
  EverFreeSpace moved{EverFreeParams{}};
  EverFreeSpace there{EverFreeParams{}};
  const SweepCloud visited = cloud_at(hall_with_somebody(), SE3::Identity(), 1);
  const SweepCloud empty_hall = cloud_at(Room::hall(), SE3::Identity(), 2);
  moved.add_sweep(visited, SE3::Identity(), 0);
  there.add_sweep(visited, T_new_old, 0);
  for (const std::size_t keyframe : {1U, 2U}) {
    moved.add_sweep(empty_hall, SE3::Identity(), keyframe, 4);
    there.add_sweep(empty_hall, T_new_old, keyframe, 4);
  }
  EXPECT_TRUE(moved.moved_points(visited, 0).empty());
  moved.drop_keyframe({.index = 1, .by = 2});
  moved.move_keyframes(std::vector{T_new_old, T_new_old});
  moved.add_sweep(empty_hall, T_new_old, 1);
  there.add_sweep(empty_hall, T_new_old, 2);
  const std::vector<bool> found = moved.moved_points(visited, 0);
  const std::vector<bool> expected = there.moved_points(visited, 0);
  ASSERT_EQ(found.size(), visited.points.size());
  EXPECT_GT(std::ranges::count(expected, true), 50);
  // Rounding of poses may bring a point at a border into the next voxel.
  std::size_t num_different = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    num_different += found[i] != expected[i] ? 1 : 0;
  }
  EXPECT_LT(num_different, found.size() / 1000);
}

// The robot is stationary for an hour: the sums must not overflow, and must not take more memory.
TEST(EverFreeSpace, MemoryDoesNotGrowWithTime) {
  EverFreeSpace space{EverFreeParams{}};
  const SweepCloud empty_hall = cloud_at(Room::hall(), SE3::Identity(), 1);
  const SweepCloud visited = cloud_at(hall_with_somebody(), SE3::Identity(), 2);
  space.add_sweep(visited, SE3::Identity(), 0);
  space.add_sweep(empty_hall, SE3::Identity(), 0, 10);
  const std::size_t memory_bytes = space.memory_bytes();
  const auto count = [](const std::vector<bool>& is_moved) {
    return std::ranges::count(is_moved, true);
  };
  const auto moved = count(space.moved_points(visited, 0));
  EXPECT_GT(moved, 0);
  for (int i = 0; i < 360; ++i) {
    space.add_sweep(empty_hall, SE3::Identity(), 0, 10);
  }
  EXPECT_EQ(space.memory_bytes(), memory_bytes);
  EXPECT_EQ(count(space.moved_points(visited, 0)), moved);
  EXPECT_EQ(count(space.moved_points(empty_hall, 0)), 0);
}

TEST(EverFreeSpace, WithoutEnoughVotesNoPointCountsAsMoved) {
  const SweepCloud cloud = cloud_at(Room::hall(), SE3::Identity(), 1);
  EXPECT_TRUE(EverFreeSpace({}).moved_points(cloud, 0).empty());
  // If there are only two sightings, either of them may be the wrong one.
  EverFreeSpace of_two{EverFreeParams{}};
  of_two.add_sweep(cloud, SE3::Identity(), 0);
  of_two.add_sweep(cloud, SE3::Identity(), 1);
  EXPECT_TRUE(of_two.moved_points(cloud, 0).empty());
  EverFreeSpace off({.remove_moved = false});
  off.add_sweep(cloud, SE3::Identity(), 0);
  EXPECT_TRUE(off.moved_points(cloud, 0).empty());
}

}  // namespace ever_free_space_test
}  // namespace nodmap::slam6d
