// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::deg_to_rad;
using geometry::SE3;

/// What a scanner 0.4 m above the base sees in all directions, 2 degrees apart; 5 mm of noise.
VoxelMap sweep_at(const Room& room, const SE3& T_world_base, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise_m(0.0, 0.005);
  std::vector<Eigen::Vector3f> points;
  const Eigen::Vector3d p_base_mirror(0.0, 0.0, 0.4);
  for (double pitch_deg = -40.0; pitch_deg <= 40.0; pitch_deg += 2.0) {
    for (double yaw_deg = 0.0; yaw_deg < 360.0; yaw_deg += 2.0) {
      const double pitch = deg_to_rad(pitch_deg);
      const double yaw = deg_to_rad(yaw_deg);
      const Eigen::Vector3d direction(std::cos(pitch) * std::cos(yaw),
                                      std::cos(pitch) * std::sin(yaw), std::sin(pitch));
      const double range_m =
          room.range_m(T_world_base * p_base_mirror, T_world_base.linear() * direction) +
          noise_m(random);
      if (range_m < 30.0) {
        points.emplace_back((p_base_mirror + range_m * direction).cast<float>());
      }
    }
  }
  return VoxelMap::from_points(points, p_base_mirror.cast<float>(), {});
}

/// 32 m x 24 m, no two walls parallel: every pose looks different.
Room slanting_hall() {
  return {{{{0, 0, 1}, 0.0},
           {{0, 0, 1}, 2.5},
           {Eigen::Vector3d(1.0, 0.1, 0.0).normalized(), 16.0},
           {Eigen::Vector3d(-1.0, 0.25, 0.0).normalized(), 16.0},
           {Eigen::Vector3d(0.15, 1.0, 0.0).normalized(), 12.0},
           {Eigen::Vector3d(-0.05, -1.0, 0.0).normalized(), 12.0}}};
}

/// `steps` steps of 1 m, round and round on a circle with a radius of 9 m: 57 m.
std::vector<SE3> circle(std::size_t steps) {
  std::vector<SE3> poses;
  for (std::size_t k = 0; k < steps; ++k) {
    const double angle = static_cast<double>(k) / 9.0;
    SE3 T = SE3::Identity();
    T.translation() = Eigen::Vector3d(9.0 * std::sin(angle), -9.0 * std::cos(angle), 0.0);
    T.linear() = geometry::rotation_of({0.0, 0.0, angle});
    poses.push_back(T);
  }
  return poses;
}

Matrix6d information(double sigma_m, double sigma_rad) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

struct Mapping {
  BackEnd back_end{{}, {}, {}, {}};
  VoxelMap map{VoxelMapParams{}};
  std::vector<SE3> T_map_keyframes;
  std::vector<SE3> truth;

  /// Tracking counts each step wrong by `error`, and says so.
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

SE3 turned_by(double heading_rad) {
  SE3 error = SE3::Identity();
  error.linear() = geometry::rotation_of({0.0, 0.0, heading_rad});
  return error;
}

// The pose drifts by 0.06 degrees a metre: 3.4 degrees after a round.
TEST(BackEnd, LoopsTakeTheDriftBack) {
  const std::vector<SE3> poses = circle(75);
  const SE3 error = turned_by(deg_to_rad(0.06));
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
  // The first ones, which were searched for, are the least exact.
  EXPECT_LE(5 * run.back_end.graph().num_contradicted(), run.back_end.graph().num_loops());
  EXPECT_LT(run.worst_m(), 0.1);
}

// What is certain is left alone: not a bit of a pose changes.
TEST(BackEnd, WithoutDriftNothingMoves) {
  Mapping run;
  run.drive(slanting_hall(), circle(75), SE3::Identity(), information(0.001, deg_to_rad(0.01)));
  EXPECT_GT(run.back_end.graph().num_loops(), 5U);
  EXPECT_EQ(run.back_end.metrics().corrections, 0);
  EXPECT_EQ(run.back_end.metrics().maps_arranged, 0);
}

// Two rooms of the same look, 24 m apart: the second is not taken for the first.
TEST(BackEnd, EqualRoomsAreNotOne) {
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

// There and back in a bare corridor: that it is the same corridor tells nothing of its length.
TEST(BackEnd, ABareCorridorMovesNothingAlongItself) {
  std::vector<SE3> poses;
  for (int k = 0; k < 60; ++k) {
    SE3 T = SE3::Identity();
    T.translation().x() = k < 30 ? k : 60 - k;
    T.linear() = geometry::rotation_of({0.0, 0.0, k < 30 ? 0.0 : geometry::kPi});
    poses.push_back(T);
  }
  // Nothing tells the length but odometry, 10 % of a step wrong.
  Matrix6d match = information(0.01, deg_to_rad(0.1));
  match(0, 0) = 1.0;
  Mapping run;
  run.drive(Room::corridor(), poses, SE3::Identity(), match);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_NEAR(run.T_map_keyframes[k].translation().x(), poses[k].translation().x(), 0.05) << k;
    EXPECT_NEAR(run.T_map_keyframes[k].translation().y(), 0.0, 0.01) << k;
  }
}

}  // namespace
}  // namespace nodmap::slam6d
