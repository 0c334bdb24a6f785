// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/cloud_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/angle.hpp"
#include "tools/evaluate/world_surfaces.hpp"

namespace nodmap::evaluate {
namespace cloud_error_test {

using Eigen::Vector3d;

sim::World world_of(std::variant<sim::Box, sim::Cylinder, sim::Ramp, sim::Mesh> shape) {
  sim::World world;
  world.objects.push_back({std::move(shape)});
  return world;
}

sim::Box box_above_the_floor() {
  return {
      .center = {1.0, 2.0, 5.0}, .size = {2.0, 4.0, 6.0}, .yaw_rad = geometry::deg_to_rad(90.0)};
}

// By hand: rotated by 90 degrees the box spans x -1..3, y 1..3, z 2..8.
TEST(WorldSurfaces, DistanceFromABoxOutsideInsideAndAtAnEdge) {
  const WorldSurfaces surfaces(world_of(box_above_the_floor()));
  EXPECT_NEAR(surfaces.distance_m({3.5, 2.0, 5.0}), 0.5, 1e-12);
  EXPECT_NEAR(surfaces.distance_m({2.8, 2.0, 5.0}), 0.2, 1e-12);
  EXPECT_NEAR(surfaces.distance_m({3.3, 3.4, 5.0}), 0.5, 1e-12);
  EXPECT_NEAR(surfaces.distance_m({0.0, 0.0, 0.25}), 0.25, 1e-12);  // the floor is nearer
}

TEST(WorldSurfaces, DistanceFromACylinder) {
  const WorldSurfaces surfaces(world_of(sim::Cylinder{{0.0, 0.0, 5.0}, 0.5, 2.0}));
  EXPECT_NEAR(surfaces.distance_m({1.5, 0.0, 5.0}), 1.0, 1e-12);
  EXPECT_NEAR(surfaces.distance_m({0.0, 0.4, 5.0}), 0.1, 1e-12);
  EXPECT_NEAR(surfaces.distance_m({0.8, 0.0, 6.4}), 0.5, 1e-12);  // 0.3 out, 0.4 up
}

TEST(WorldSurfaces, AboveAPitTheNearestFloorIsItsEdge) {
  sim::World world;
  world.pits.push_back({{0.0, 0.0}, {2.0, 2.0}, 1.0});
  const WorldSurfaces surfaces(world);
  EXPECT_NEAR(surfaces.distance_m({0.3, 1.0, 0.4}), 0.5, 1e-12);
  EXPECT_NEAR(surfaces.distance_m({1.0, 1.0, -0.9}), 0.1, 1e-12);  // its bottom
  EXPECT_NEAR(surfaces.distance_m({1.9, 1.0, -0.5}), 0.1, 1e-12);  // its wall
  EXPECT_NEAR(surfaces.distance_m({-1.0, 1.0, 0.4}), 0.4, 1e-12);  // beside it
}

// Oracle: the nearest of many samples is never nearer than the distance, and at most about a
// diagonal of the sampling, 0.7 * 0.02 m, farther.
TEST(WorldSurfaces, DistanceAgreesWithTheNearestSample) {
  sim::World world = world_of(box_above_the_floor());
  world.objects.push_back({sim::Cylinder{{-4.0, 0.0, 4.0}, 0.5, 2.0}});
  world.objects.push_back({sim::Ramp{{3.0, -4.0, 3.0}, {6.0, -3.0, 5.0}, 1.0}});
  const WorldSurfaces surfaces(world);
  std::vector<Vector3d> samples;
  surfaces.for_each_sample(0.02, [&samples](const Vector3d& p) { samples.push_back(p); });
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> place(-6.0, 6.0);
  for (int i = 0; i < 30; ++i) {
    // High above the floor, which is not sampled, and not above the lids of the cylinder, either.
    const Vector3d p(place(engine), place(engine), 4.0);
    double nearest = 1e9;
    for (const Vector3d& q : samples) {
      nearest = std::min(nearest, (p - q).norm());
    }
    const double exact = std::min(surfaces.distance_m(p), 4.0);
    EXPECT_GE(nearest, exact - 1e-9);
    if (exact < 4.0) {
      EXPECT_LE(nearest, exact + 0.02);
    }
  }
}

TEST(CloudError, OfAFloorThatIsTiltedAndAnOutlier) {
  sim::World world;
  std::vector<Eigen::Vector3f> cloud;
  for (int i = 0; i < 99; ++i) {
    cloud.emplace_back(static_cast<float>(i), 0.0F, i % 2 == 0 ? 0.02F : -0.02F);
  }
  cloud.emplace_back(0.0F, 0.0F, 1.0F);
  const CloudErrors errors = measure_cloud(cloud, geometry::SE3::Identity(), world);
  EXPECT_EQ(errors.n, 100U);
  EXPECT_NEAR(errors.p95_m, 0.02, 1e-6);  // floats
  EXPECT_NEAR(errors.outlier_share, 0.01, 1e-12);
  EXPECT_NEAR(errors.rms_m, std::sqrt((99.0 * 0.0004 + 1.0) / 100.0), 1e-6);
}

// The map's origin is the robot's start: a point 1 m ahead of it is not at x = 1 m in the world.
TEST(CloudError, IsMeasuredInTheWorld) {
  const sim::World world = world_of(sim::Cylinder{{5.0, 6.0, 1.0}, 0.5, 2.0});
  const geometry::SE3 T_world_map = geometry::to_se3({5.0, 5.0, geometry::deg_to_rad(90.0)});
  const std::vector<Eigen::Vector3f> cloud{{0.5F, 0.0F, 1.0F}};
  EXPECT_NEAR(measure_cloud(cloud, T_world_map, world).rms_m, 0.0, 1e-6);
}

TEST(CloudError, CompletenessIsTheShareThatWasSeen) {
  const sim::World world = world_of(sim::Box{{0.0, 0.0, 5.0}, {1.0, 1.0, 1.0}, 0.0});
  std::vector<Eigen::Vector3f> face;  // one of six
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      face.emplace_back(0.5F, -0.475F + 0.05F * static_cast<float>(i),
                        4.525F + 0.05F * static_cast<float>(j));
    }
  }
  // The rows of the four adjacent faces that are nearer than 0.1 m count as well: 2 of 20.
  const CloudErrors errors = measure_cloud(face, geometry::SE3::Identity(), world);
  EXPECT_NEAR(errors.completeness, (1.0 + 4.0 * 2.0 / 20.0) / 6.0, 1e-9);
}

// By hand: of 80 static points 76 are kept, of 20 moving points 5.
TEST(RemovalErrors, SharesOfStaticAndOfMovingPoints) {
  const RemovalErrors errors =
      measure_removal({.n = 100, .outlier_share = 0.2}, {.n = 81, .outlier_share = 5.0 / 81.0});
  EXPECT_NEAR(errors.static_kept, 0.95, 1e-12);
  EXPECT_NEAR(errors.dynamic_removed, 0.75, 1e-12);
  EXPECT_NEAR(errors.associated, std::sqrt(0.95 * 0.75), 1e-12);
}

TEST(RemovalErrors, WithoutMovingPointsAllOfThemAreRemoved) {
  const RemovalErrors errors = measure_removal({.n = 10}, {.n = 10});
  EXPECT_EQ(errors.static_kept, 1.0);
  EXPECT_EQ(errors.dynamic_removed, 1.0);
}

}  // namespace cloud_error_test
}  // namespace nodmap::evaluate
