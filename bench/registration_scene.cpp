// SPDX-License-Identifier: BSD-3-Clause
#include "bench/registration_scene.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::bench {
namespace {

using geometry::SE3;

constexpr double kLengthM = 24.0;
constexpr double kWidthM = 14.0;
constexpr double kHeightM = 2.8;
constexpr double kThicknessM = 0.1;
constexpr double kHalfCorridorM = 1.2;
constexpr double kSensorHeightM = 1.0;
constexpr double kMaxRangeM = 30.0;

class FloorMaker {
 public:
  explicit FloorMaker(std::uint64_t seed) : random_(seed) {}

  sim::World make() {
    box({0.5 * kLengthM, 0.0, kHeightM + 0.05}, {kLengthM, kWidthM, 0.1});
    for (const double end : {0.0, kLengthM}) {
      box({end, 0.0, 0.5 * kHeightM}, {kThicknessM, kWidthM, kHeightM});
    }
    make_side(1.0, 3);
    make_side(-1.0, 4);
    return world_;
  }

 private:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }

  void box(const Eigen::Vector3d& center, const Eigen::Vector3d& size, double yaw_rad = 0.0) {
    world_.objects.push_back({sim::Box{center, size, yaw_rad}});
  }

  // The rooms on one side of the corridor.
  void make_side(double side, int num_rooms) {
    box({0.5 * kLengthM, side * 0.5 * kWidthM, 0.5 * kHeightM}, {kLengthM, kThicknessM, kHeightM});
    double x = 0.0;
    for (int room = 0; room < num_rooms; ++room) {
      const double next = room + 1 == num_rooms
                              ? kLengthM
                              : x + (kLengthM - x) / (num_rooms - room) * between(0.8, 1.2);
      const double door = between(x + 1.0, next - 2.0);
      const double y = side * kHalfCorridorM;
      box({0.5 * (x + door), y, 0.5 * kHeightM}, {door - x, kThicknessM, kHeightM});
      box({0.5 * (door + 1.0 + next), y, 0.5 * kHeightM},
          {next - door - 1.0, kThicknessM, kHeightM});
      box({door + 0.5, y, 0.5 * (2.1 + kHeightM)}, {1.0, kThicknessM, kHeightM - 2.1});
      const double middle = 0.5 * side * (kHalfCorridorM + 0.5 * kWidthM);
      box({next, middle, 0.5 * kHeightM}, {kThicknessM, 0.5 * kWidthM - kHalfCorridorM, kHeightM});
      furnish(x, next, side);
      x = next;
    }
  }

  void furnish(double x_min, double x_max, double side) {
    const int num_things = 4 + static_cast<int>(between(0.0, 4.0));
    for (int i = 0; i < num_things; ++i) {
      const double x = between(x_min + 0.8, x_max - 0.8);
      const double y = side * between(kHalfCorridorM + 0.9, 0.5 * kWidthM - 0.5);
      const double yaw_rad = between(-geometry::kPi, geometry::kPi);
      switch (static_cast<int>(between(0.0, 4.0))) {
        case 0:
          table(x, y, yaw_rad);
          break;
        case 1: {
          const double height_m = between(0.6, 2.0);
          box({x, y, 0.5 * height_m}, {between(0.4, 1.2), between(0.3, 0.6), height_m}, yaw_rad);
          break;
        }
        case 2:
          world_.objects.push_back(
              {sim::Cylinder{{x, y, 0.5 * kHeightM}, between(0.05, 0.25), kHeightM}});
          break;
        default:
          box({x, y, between(2.2, 2.6)}, {between(1.0, 2.5), 0.2, 0.2}, yaw_rad);
          break;
      }
    }
  }

  void table(double x, double y, double yaw_rad) {
    const double length_m = between(1.0, 1.8);
    const double width_m = between(0.6, 0.9);
    box({x, y, 0.735}, {length_m, width_m, 0.03}, yaw_rad);
    const geometry::SE2 T_world_table{x, y, yaw_rad};
    for (const double u : {-0.45, 0.45}) {
      for (const double v : {-0.45, 0.45}) {
        const Eigen::Vector2d leg = T_world_table * Eigen::Vector2d(u * length_m, v * width_m);
        world_.objects.push_back({sim::Cylinder{{leg.x(), leg.y(), 0.36}, 0.03, 0.72}});
      }
    }
  }

  sim::World world_;
  std::mt19937_64 random_;
};

}  // namespace

sim::World furnished_floor(std::uint64_t seed) {
  return FloorMaker(seed).make();
}

std::vector<Eigen::Vector3f> nodding_sweep(const sim::RayCaster& world, const SE3& T_world_sensor,
                                           const SweepShape& shape, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, shape.noise_m);
  std::vector<Eigen::Vector3f> points;
  points.reserve(static_cast<std::size_t>(shape.lines) * static_cast<std::size_t>(shape.beams));
  for (int line = 0; line < shape.lines; ++line) {
    const Eigen::Matrix3d pitch =
        geometry::pitch_rotation(geometry::deg_to_rad(-50.0 + 90.0 * line / (shape.lines - 1)));
    for (int beam = 0; beam < shape.beams; ++beam) {
      const double angle_rad = geometry::deg_to_rad(-90.0 + 180.0 * beam / (shape.beams - 1));
      const Eigen::Vector3d direction =
          pitch * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
      const auto hit = world.cast(
          {T_world_sensor.translation(), T_world_sensor.linear() * direction}, kMaxRangeM);
      if (hit) {
        points.emplace_back(((hit->distance_m + noise(random)) * direction).cast<float>());
      }
    }
  }
  return points;
}

std::vector<SE3> drive_on_floor(std::size_t num_poses, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::normal_distribution<double> tilt(0.0, geometry::deg_to_rad(0.4));
  std::normal_distribution<double> bump(0.0, 0.006);
  std::vector<SE3> poses;
  double x = 1.0;
  double y = 0.0;
  double heading_rad = 0.0;
  double goal_rad = 0.0;
  while (poses.size() < num_poses) {
    SE3 pose = SE3::Identity();
    pose.translation() = Eigen::Vector3d(x, y, kSensorHeightM + bump(random));
    pose.linear() = (Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(tilt(random), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(tilt(random), Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    poses.push_back(pose);
    if ((x > kLengthM - 2.0 && goal_rad == 0.0) || (x < 2.0 && goal_rad != 0.0)) {
      goal_rad = geometry::kPi - goal_rad;
    }
    const double rest_rad = goal_rad - heading_rad;
    if (std::abs(rest_rad) > geometry::deg_to_rad(20.0)) {
      heading_rad += std::copysign(geometry::deg_to_rad(22.5), rest_rad);
      continue;
    }
    // Back to the middle of the corridor, with a small alternating offset.
    const double sign = goal_rad == 0.0 ? 1.0 : -1.0;
    heading_rad = goal_rad - sign * 0.3 * y + geometry::deg_to_rad(4.0) * any(random);
    x += 0.5 * std::cos(heading_rad);
    y += 0.5 * std::sin(heading_rad);
  }
  return poses;
}

SE3 disturbed(const SE3& pose, double sigma_m, double sigma_rad, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  SE3 error = SE3::Identity();
  error.translation() = sigma_m * vector();
  const Eigen::Vector3d rotation = sigma_rad * vector();
  error.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  return pose * error;
}

}  // namespace nodmap::bench
