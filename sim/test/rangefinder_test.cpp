// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/rangefinder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::sim {
namespace rangefinder_test {

using geometry::deg_to_rad;

LaserParams without_noise() {
  LaserParams params;
  params.range_sigma_m = 0.0;
  return params;
}

geometry::SE3 laser() {
  geometry::SE3 T_world_laser = geometry::SE3::Identity();
  T_world_laser.translation().z() = 1.0;
  return T_world_laser;
}

// A wall across the x axis at `x_m`, from `y_min` to the left.
Object wall(double x_m, double reflectivity, double y_min = -50.0) {
  return {Box{{x_m + 0.05, y_min + 50.0, 1.0}, {0.1, 100.0, 2.0}, 0.0}, reflectivity};
}

Echo look(const World& world, const LaserParams& params, double angle_rad = 0.0) {
  const RayCaster caster(world);
  return Rangefinder(params, 1).measure(caster, laser(), angle_rad, {});
}

TEST(Rangefinder, MeasuresWallsAtAnyAngle) {
  World world;
  world.objects.push_back(wall(3.0, 0.8));
  for (const double deg : {-70.0, -30.0, 0.0, 45.0, 75.0}) {
    const Echo echo = look(world, without_noise(), deg_to_rad(deg));
    ASSERT_EQ(echo.kind, Echo::Kind::kRange);
    const double range_m = 3.0 / std::cos(deg_to_rad(deg));
    // On an oblique wall the mean over the spot is too long, by a term of second order in the
    // spot's angle; below 1e-3 at 75 degrees.
    EXPECT_NEAR(echo.range_m / range_m, 1.0, 1e-3) << deg;
  }
}

// Seen at a slant from 0.38 m above it, a floor of reflectivity r returns r * 0.38 m / d at 1 m and
// so r * 0.38 m^3 / d^3 at d: as much as is needed up to 7.2 m if r is 0.8, up to 3.6 m if it is
// 0.1.
TEST(Rangefinder, ADarkFloorIsSeenOnlyNearby) {
  for (const auto& [reflectivity, reach_m] : {std::pair{0.8, 7.2}, {0.3, 5.2}, {0.1, 3.6}}) {
    World world;
    world.floor_reflectivity = reflectivity;
    const RayCaster caster(world);
    const auto kind_at = [&](double range_m) {
      geometry::SE3 T_world_laser = geometry::SE3::Identity();
      T_world_laser.translation().z() = 0.38;
      T_world_laser.linear() = geometry::pitch_rotation(-std::asin(0.38 / range_m));
      return Rangefinder(without_noise(), 1).measure(caster, T_world_laser, 0.0, {}).kind;
    };
    EXPECT_EQ(kind_at(0.9 * reach_m), Echo::Kind::kRange) << reflectivity;
    EXPECT_EQ(kind_at(1.1 * reach_m), Echo::Kind::kNothing) << reflectivity;
  }
}

TEST(Rangefinder, NoiseHasItsSigmaAndBias) {
  World world;
  world.objects.push_back(wall(4.0, 0.8));
  const RayCaster caster(world);
  LaserParams params;
  params.range_bias_m = 0.02;
  Rangefinder rangefinder(params, 5);
  double sum = 0.0;
  double sum_sq = 0.0;
  constexpr int kShots = 20'000;
  for (int i = 0; i < kShots; ++i) {
    const double error = rangefinder.measure(caster, laser(), 0.0, {}).range_m - 4.02;
    sum += error;
    sum_sq += error * error;
  }
  // Four standard errors: 4 sigma / sqrt(n), and 4 / sqrt(2 n) of sigma.
  EXPECT_NEAR(sum / kShots, 0.0, 4.0 * params.range_sigma_m / std::sqrt(kShots));
  EXPECT_NEAR(std::sqrt(sum_sq / kShots) / params.range_sigma_m, 1.0, 0.02);
}

TEST(Rangefinder, DarkSurfacesHaveAShorterRange) {
  const LaserParams params = without_noise();
  for (const double reflectivity : {0.1, 0.4, 0.75, 1.0}) {
    // Lambert's law head on: rho / d^2 is the least intensity. The spot's width costs less than
    // 1e-4.
    const double reach_m = std::sqrt(reflectivity / params.min_intensity);
    for (const double share : {0.99, 1.01}) {
      World world;
      world.objects.push_back(wall(share * reach_m, reflectivity));
      EXPECT_EQ(look(world, params).kind, share < 1.0 ? Echo::Kind::kRange : Echo::Kind::kNothing);
    }
    // From the data sheet: 10 m at 10 %, 30 m at 75 %.
    EXPECT_GT(reach_m, reflectivity >= 0.75 ? 30.0 : 10.0);
  }
}

TEST(Rangefinder, IntensityFallsWithIncidenceAndDistance) {
  World world;
  world.objects.push_back(wall(4.0, 0.8));
  const LaserParams params = without_noise();
  // rho cos(a) / (d / cos(a))^2. The tolerance is 1.25 times the measured effect of the spot's
  // other rays.
  EXPECT_NEAR(look(world, params).intensity, 0.8 / 16.0, 2.2e-7);
  const double c = std::cos(deg_to_rad(60.0));
  EXPECT_NEAR(look(world, params, deg_to_rad(60.0)).intensity / (0.8 * c * c * c / 16.0), 1.0,
              1.7e-5);
}

TEST(Rangefinder, AtAnEdgeTheRangeIsTheMeanWeightedByLight) {
  // The front wall begins just beside y = 0: the left ray of the spot hits it, the three rays in
  // the middle line do not.
  const LaserParams params = without_noise();
  for (const double back_reflectivity : {0.8, 0.4}) {
    World world;
    world.objects.push_back(wall(3.0, 0.8, 1e-4));
    world.objects.push_back(wall(4.0, back_reflectivity));
    const Echo echo = look(world, params);
    ASSERT_EQ(echo.kind, Echo::Kind::kRange);
    const double front = 1.0 * 0.8 / 9.0;
    const double back = 4.0 * back_reflectivity / 16.0;
    // The rays at the spot's edge are 4 um longer at 3 m, and more at 4 m.
    EXPECT_NEAR(echo.range_m, (3.0 * front + 4.0 * back) / (front + back), 6e-6);
  }
}

TEST(Rangefinder, SurfacesFarApartDoNotMix) {
  const LaserParams params = without_noise();
  World world;
  world.objects.push_back(wall(3.0, 0.8, 1e-4));
  world.objects.push_back(wall(3.0 + 2.0 * params.pulse_length_m, 0.8));
  // The rays at the spot's edge are 4 um longer.
  EXPECT_NEAR(look(world, params).range_m, 3.0, 6e-6);
  // Too dark for an echo of its own, so the surface behind it is measured.
  world.objects[0].reflectivity = 1e-3;
  EXPECT_NEAR(look(world, params).range_m, 3.0 + 2.0 * params.pulse_length_m, 8e-6);
}

TEST(Rangefinder, SpotGrowsWithDistance) {
  // A pole of 1 cm beside the beam's axis is hit only where the spot is wide enough.
  const LaserParams params = without_noise();
  const auto meets = [&](double x_m) {
    World world;
    world.objects.push_back({Cylinder{{x_m, 0.02, 1.0}, 0.005, 2.0}});
    return look(world, params).kind == Echo::Kind::kRange;
  };
  EXPECT_FALSE(meets(2.0));  // 5 mm + 2 m * 2.2 mrad = 9 mm, less than 15 mm
  EXPECT_TRUE(meets(8.0));   // the outer ring is at 0.77 * (5 mm + 8 m * 2.2 mrad) = 17 mm
}

TEST(Rangefinder, AReflectorDazzlesOnlyFromNearAndHeadOn) {
  const LaserParams params = without_noise();
  World world;
  world.objects.push_back(wall(1.5, 5.0));
  EXPECT_EQ(look(world, params).kind, Echo::Kind::kDazzled);
  EXPECT_EQ(look(world, params, deg_to_rad(40.0)).kind, Echo::Kind::kRange);
  world.objects[0] = wall(6.0, 5.0);
  EXPECT_EQ(look(world, params).kind, Echo::Kind::kRange);
  world.objects[0] = wall(0.5, 1.0);  // white does not dazzle at any distance
  EXPECT_EQ(look(world, params).kind, Echo::Kind::kRange);
}

TEST(Rangefinder, ABlackSurfaceGivesNoEcho) {
  LaserParams params = without_noise();
  params.min_intensity = 0.0;
  World world;
  world.objects.push_back(wall(1.0, 0.0));
  EXPECT_EQ(look(world, params).kind, Echo::Kind::kNothing);
  EXPECT_EQ(look({}, params).kind, Echo::Kind::kNothing);
}

}  // namespace rangefinder_test
}  // namespace nodmap::sim
