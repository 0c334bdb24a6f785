// SPDX-License-Identifier: BSD-3-Clause
// Whole sweeps in halls, and maps of them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {

/// The cloud of a stationary scanner 0.4 m above the base, in base, with beams 2 degrees apart: all
/// around, and pitched from -40 to 40 degrees. The ranges have 5 mm of noise.
inline SweepCloud cloud_at(const Room& room, const geometry::SE3& T_world_base, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise_m(0.0, 0.005);
  SweepCloud cloud;
  const Eigen::Vector3d p_base_mirror(0.0, 0.0, 0.4);
  for (double pitch_deg = -40.0; pitch_deg <= 40.0; pitch_deg += 2.0) {
    for (double yaw_deg = 0.0; yaw_deg < 360.0; yaw_deg += 2.0) {
      const double pitch = geometry::deg_to_rad(pitch_deg);
      const double yaw = geometry::deg_to_rad(yaw_deg);
      const Eigen::Vector3d direction(std::cos(pitch) * std::cos(yaw),
                                      std::cos(pitch) * std::sin(yaw), std::sin(pitch));
      const double range_m =
          room.range_m(T_world_base * p_base_mirror, T_world_base.linear() * direction) +
          noise_m(random);
      if (range_m < 30.0) {
        cloud.points.emplace_back((p_base_mirror + range_m * direction).cast<float>());
      }
    }
  }
  cloud.lines.push_back({.p_base_mirror = p_base_mirror.cast<float>(), .end = cloud.points.size()});
  return cloud;
}

inline VoxelMap sweep_at(const Room& room, const geometry::SE3& T_world_base, unsigned seed) {
  const SweepCloud cloud = cloud_at(room, T_world_base, seed);
  return VoxelMap::from_points(cloud.points, cloud.p_base_mirror(), {});
}

inline geometry::SE3 pose(double x_m, double y_m, double yaw_deg) {
  geometry::SE3 T = geometry::SE3::Identity();
  T.translation() = Eigen::Vector3d(x_m, y_m, 0.0);
  T.linear() = geometry::rotation_of({0.0, 0.0, geometry::deg_to_rad(yaw_deg)});
  return T;
}

/// A map of sweeps that are taken at these poses.
struct TestMap {
  TestMap(const Room& room, const std::vector<geometry::SE3>& poses) {
    for (const geometry::SE3& T_map_base : poses) {
      const auto seed = static_cast<unsigned>(keyframes.size());
      voxels.add_sweep(sweep_at(room, T_map_base, seed), T_map_base, keyframes.size());
      Keyframe keyframe;
      keyframe.T_map_base = T_map_base;
      keyframe.cloud = std::make_shared<const SweepCloud>(cloud_at(room, T_map_base, seed));
      keyframes.push_back(std::move(keyframe));
    }
  }

  std::vector<Keyframe> keyframes;
  VoxelMap voxels{VoxelMapParams{}};
};

/// Four walls around the robot at this distance, as if people blocked its whole view: they fit
/// nowhere.
inline Room box_about_robot(double half_width_m) {
  return {{{{1, 0, 0}, half_width_m},
           {{-1, 0, 0}, half_width_m},
           {{0, 1, 0}, half_width_m},
           {{0, -1, 0}, half_width_m}}};
}

/// So near that hardly any plane is seen (registration.min_planes).
inline constexpr double kBlindM = 0.12;

/// Poses along Room::hall(), 1 m apart, from x = -2.5 m to x = 3.5 m.
inline std::vector<geometry::SE3> along_hall() {
  std::vector<geometry::SE3> poses;
  for (double x_m = -2.5; x_m < 4.0; x_m += 1.0) {
    poses.push_back(pose(x_m, 0.0, 0.0));
  }
  return poses;
}

/// A hall that differs from Room::hall() only by a cabinet at each wall, as if the building had a
/// similar hall elsewhere.
inline Room look_alike_hall() {
  Room room = Room::hall();
  room.boxes = {{Eigen::Vector3d(1.0, 0.5, 0.0), Eigen::Vector3d(2.2, 1.1, 1.8)},
                {Eigen::Vector3d(-1.2, -0.9, 0.0), Eigen::Vector3d(-0.2, -0.4, 1.8)}};
  return room;
}

/// A hall of about 32 m x 24 m in which no two walls are parallel, so that it looks different from
/// every pose.
inline Room slanting_hall() {
  return {{{{0, 0, 1}, 0.0},
           {{0, 0, 1}, 2.5},
           {Eigen::Vector3d(1.0, 0.1, 0.0).normalized(), 16.0},
           {Eigen::Vector3d(-1.0, 0.25, 0.0).normalized(), 16.0},
           {Eigen::Vector3d(0.15, 1.0, 0.0).normalized(), 12.0},
           {Eigen::Vector3d(-0.05, -1.0, 0.0).normalized(), 12.0}}};
}

/// The poses of `steps` steps of 1 m on a circle with a radius of 9 m; one round has 57 m.
inline std::vector<geometry::SE3> circle(std::size_t steps) {
  std::vector<geometry::SE3> poses;
  for (std::size_t k = 0; k < steps; ++k) {
    const double angle = static_cast<double>(k) / 9.0;
    geometry::SE3 T = geometry::SE3::Identity();
    T.translation() = Eigen::Vector3d(9.0 * std::sin(angle), -9.0 * std::cos(angle), 0.0);
    T.linear() = geometry::rotation_of({0.0, 0.0, angle});
    poses.push_back(T);
  }
  return poses;
}

}  // namespace nodmap::slam6d
