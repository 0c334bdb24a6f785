// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/back_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace back_end_test {

using geometry::deg_to_rad;
using geometry::SE3;

Matrix6d information(double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

struct Mapping {
  BackEnd back_end{{}, {}, {}, {}};
  VoxelMap map{VoxelMapParams{}};
  std::vector<SE3> T_map_keyframes;
  std::vector<SE3> truth;

  // Adds a keyframe for each pose. Tracking measures each step with this error, and with this
  // information.
  void drive(const Room& room, const std::vector<SE3>& poses, const SE3& error,
             const Matrix6d& step_information) {
    for (const SE3& T_world_base : poses) {
      SE3 T_map_base =
          truth.empty() ? T_world_base
                        : T_map_keyframes.back() * (truth.back().inverse() * T_world_base) * error;
      add(sweep_at(room, T_world_base, static_cast<unsigned>(truth.size())), T_map_base,
          step_information);
      truth.push_back(T_world_base);
    }
  }

  void add(const VoxelMap& sweep, const SE3& T_map_base, const Matrix6d& step_information) {
    map.add_sweep(sweep, T_map_base, T_map_keyframes.size());
    T_map_keyframes.push_back(T_map_base);
    const auto moved = back_end.add_keyframe(
        {.T_map_base = T_map_base, .information = step_information}, sweep, map);
    if (moved) {
      T_map_keyframes = *moved;
    }
  }

  [[nodiscard]] double worst_m() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      worst = std::max(worst, (T_map_keyframes[k].translation() - truth[k].translation()).norm());
    }
    return worst;
  }
};

SE3 rotated_by(double heading_rad) {
  SE3 error = SE3::Identity();
  error.linear() = geometry::rotation_of({0.0, 0.0, heading_rad});
  return error;
}

// The heading drifts by 0.06 degrees a metre, which is 3.4 degrees in a round.
TEST(BackEnd, LoopClosuresCorrectTheDrift) {
  const std::vector<SE3> poses = circle(75);
  const SE3 error = rotated_by(deg_to_rad(0.06));
  SE3 T_drifted = poses[0];
  double drift_m = 0.0;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    T_drifted = T_drifted * (poses[k - 1].inverse() * poses[k]) * error;
    drift_m = std::max(drift_m, (T_drifted.translation() - poses[k].translation()).norm());
  }
  EXPECT_GT(drift_m, 0.2);
  Mapping run;
  run.drive(slanting_hall(), poses, error, information(0.03, deg_to_rad(0.5)));
  EXPECT_GT(run.back_end.graph().num_loops(), 10U);
  EXPECT_EQ(run.back_end.graph().num_contradicted(), 0U);
  EXPECT_LT(run.worst_m(), 1.25 * 0.077);  // as measured
}

// The poses are certain, so not a single bit of them may change. What is tracked against an earlier
// place counts as a loop at once, although the graph is never optimised.
TEST(BackEnd, WithoutDriftNoPoseChanges) {
  Mapping run;
  run.drive(slanting_hall(), circle(75), SE3::Identity(), information(0.001, deg_to_rad(0.01)));
  EXPECT_GT(run.back_end.graph().num_loops(), 5U);
  EXPECT_EQ(run.back_end.metrics().corrections, 0);
  EXPECT_EQ(run.back_end.metrics().maps_arranged, 0);
  EXPECT_TRUE(std::ranges::all_of(run.back_end.graph().loops(),
                                  [](const auto& loop) { return loop.holds(); }));
}

// Two rooms that look the same are 24 m apart: the second must not be taken for the first.
TEST(BackEnd, LoopBetweenIdenticalRoomsIsRefused) {
  Mapping run;
  SE3 T_rooms = SE3::Identity();
  T_rooms.translation().x() = 24.0;
  const std::vector<SE3> in_room = circle(50);
  for (const bool is_second : {false, true}) {
    for (std::size_t k = 0; k < in_room.size(); ++k) {
      const SE3 T_map_base = (is_second ? T_rooms : SE3::Identity()) * in_room[k];
      run.truth.push_back(T_map_base);
      run.add(sweep_at(slanting_hall(), in_room[k], static_cast<unsigned>(run.truth.size())),
              T_map_base, information(0.05, deg_to_rad(1.0)));
    }
  }
  EXPECT_EQ(run.back_end.graph().num_loops(), 0U);
  EXPECT_EQ(run.worst_m(), 0.0);
}

SavedMap saved(const Mapping& run) {
  SavedMap map;
  for (std::size_t k = 0; k < run.T_map_keyframes.size(); ++k) {
    map.keyframes.push_back({.cloud = nullptr, .T_map_base = run.T_map_keyframes[k]});
  }
  const KeyframeGraph& graph = run.back_end.graph();
  map.steps.assign(graph.steps().begin(), graph.steps().end());
  for (const KeyframeGraph::WeightedLoop& loop : graph.loops()) {
    map.loops.push_back(loop.edge);
  }
  return map;
}

// After a restart it is not known how the robot has moved since the last keyframe. The new one is
// therefore joined to the nearest.
TEST(BackEnd, ASavedMapIsContinuedFromTheNearestKeyframe) {
  Mapping before;
  before.drive(slanting_hall(), circle(75), SE3::Identity(), information(0.001, deg_to_rad(0.01)));
  BackEnd after(LoopParams{}, RegistrationParams{}, OdometryParams{}, VoxelMapParams{});
  after.restore(saved(before));
  EXPECT_EQ(after.graph().num_loops(), before.back_end.graph().num_loops());
  const SE3 T_map_base = circle(75)[20];
  const VoxelMap sweep = sweep_at(slanting_hall(), T_map_base, 99);
  before.map.add_sweep(sweep, T_map_base, 75);
  EXPECT_FALSE(after.add_keyframe(
      {.T_map_base = T_map_base, .information = information(0.001, deg_to_rad(0.01))}, sweep,
      before.map));
  ASSERT_EQ(after.graph().steps().size(), 75U);
  const registration::PoseEdge3d& step = after.graph().steps().back();
  EXPECT_EQ(step.from, 20U);
  EXPECT_EQ(step.to, 75U);
  // The edges of the saved graph are restored, too: the round is certain, so the map is not
  // arranged anew.
  EXPECT_EQ(after.metrics().maps_arranged, 0);
}

// The robot drives along a bare corridor and back. Recognising the corridor does not determine its
// length.
TEST(BackEnd, LoopClosuresDoNotChangeTheLengthOfABareCorridor) {
  std::vector<SE3> poses;
  for (int k = 0; k < 60; ++k) {
    SE3 T = SE3::Identity();
    T.translation().x() = k < 30 ? k : 60 - k;
    T.linear() = geometry::rotation_of({0.0, 0.0, k < 30 ? 0.0 : geometry::kPi});
    poses.push_back(T);
  }
  // The match does not determine the position along the corridor: a standard deviation of 1 m for a
  // step of 1 m.
  Matrix6d match = information(0.01, deg_to_rad(0.1));
  match(0, 0) = 1.0;
  Mapping run;
  run.drive(Room::corridor(), poses, SE3::Identity(), match);
  EXPECT_GT(run.back_end.graph().num_loops(), 10U);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_NEAR(run.T_map_keyframes[k].translation().x(), poses[k].translation().x(), 1e-9) << k;
    EXPECT_NEAR(run.T_map_keyframes[k].translation().y(), 0.0, 1e-9) << k;
  }
}

}  // namespace back_end_test
}  // namespace nodmap::slam6d
