// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/cloud_downsampler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace nodmap::foxglove {
namespace cloud_downsampler_test {

constexpr double kSpacing = 0.05;
constexpr float kSpacingF = 0.05F;
constexpr std::size_t kAll = 1'000'000;

CloudView cloud_of(std::vector<float> xyz_m) {
  CloudView cloud;
  cloud.xyz_m = std::move(xyz_m);
  return cloud;
}

CloudView random_cloud(std::size_t points, float half_size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-half_size, half_size);
  CloudView cloud;
  for (std::size_t i = 0; i < 3 * points; ++i) {
    cloud.xyz_m.push_back(coordinate(random));
  }
  return cloud;
}

Eigen::Vector3f point(const CloudView& cloud, std::size_t i) {
  return {cloud.xyz_m[3 * i], cloud.xyz_m[3 * i + 1], cloud.xyz_m[3 * i + 2]};
}

std::size_t size(const CloudView& cloud) {
  return cloud.xyz_m.size() / 3;
}

TEST(CloudDownsampler, KeptPointsAreFarApartAndDroppedOnesAreNearAKeptOne) {
  CloudDownsampler downsampler(kSpacing, kAll);
  const CloudView all = random_cloud(4000, 0.4F, 1);
  CloudView kept = all;
  downsampler.downsample(kept);
  ASSERT_GT(size(kept), 100U);
  ASSERT_LT(size(kept), 2000U);
  for (std::size_t i = 0; i < size(kept); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GT((point(kept, i) - point(kept, j)).cwiseAbs().maxCoeff(), 0.999F * kSpacingF);
    }
  }
  for (std::size_t i = 0; i < size(all); ++i) {
    float nearest = 1.0F;
    for (std::size_t j = 0; j < size(kept); ++j) {
      nearest = std::min(nearest, (point(all, i) - point(kept, j)).norm());
    }
    ASSERT_LE(nearest, 2.0F * std::sqrt(3.0F) * kSpacingF);  // across two cubes
  }
}

TEST(CloudDownsampler, TheSamePointsAgainAreDroppedWhateverTheBasePose) {
  CloudDownsampler downsampler(kSpacing, kAll);
  const CloudView all = random_cloud(1000, 1.0F, 2);
  CloudView first = all;
  downsampler.downsample(first);
  // The same points, relative to another base pose.
  CloudView again = all;
  again.T_frame_points.translation() = Eigen::Vector3d(3.0, -2.0, 0.5);
  for (std::size_t i = 0; i < size(again); ++i) {
    again.xyz_m[3 * i] -= 3.0F;
    again.xyz_m[3 * i + 1] += 2.0F;
    again.xyz_m[3 * i + 2] -= 0.5F;
  }
  downsampler.downsample(again);
  EXPECT_EQ(size(again), 0U);
  // Elsewhere, by a whole number of cubes, they are downsampled as at first.
  CloudView elsewhere = all;
  elsewhere.T_frame_points.translation() = Eigen::Vector3d(3.0, -2.0, 0.5);
  downsampler.downsample(elsewhere);
  EXPECT_EQ(elsewhere.xyz_m, first.xyz_m);
}

TEST(CloudDownsampler, WithoutASpacingOnlyEqualPointsAreDropped) {
  CloudDownsampler downsampler(0.0, kAll);
  CloudView cloud = cloud_of({1, 2, 3, 1, 2, 3});
  downsampler.downsample(cloud);
  EXPECT_EQ(size(cloud), 2U);
}

TEST(CloudDownsampler, KeepsAPointAgainAfterItWasForgotten) {
  CloudDownsampler downsampler(kSpacing, 100);
  const CloudView place = cloud_of({0, 0, 0});
  CloudView first = place;
  downsampler.downsample(first);
  CloudView far = random_cloud(50, 1.0F, 3);
  far.T_frame_points.translation().x() = 100.0;
  downsampler.downsample(far);
  CloudView still = place;
  downsampler.downsample(still);
  EXPECT_EQ(size(still), 0U);
  for (int i = 2; i < 5; ++i) {
    far = random_cloud(50, 1.0F, 3);
    far.T_frame_points.translation().x() = 100.0 * i;
    downsampler.downsample(far);
  }
  CloudView again = place;
  downsampler.downsample(again);
  EXPECT_EQ(size(again), 1U);
}

TEST(CloudDownsampler, KeepsAllPointsAgainAfterClear) {
  CloudDownsampler downsampler(kSpacing, kAll);
  CloudView first = cloud_of({1, 2, 3});
  downsampler.downsample(first);
  downsampler.clear();
  CloudView again = cloud_of({1, 2, 3});
  downsampler.downsample(again);
  EXPECT_EQ(size(again), 1U);
}

TEST(CloudDownsampler, KeepsPointsThatAreTooFarAwayOrInvalid) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  CloudDownsampler downsampler(kSpacing, kAll);
  for (int i = 0; i < 2; ++i) {
    CloudView cloud = cloud_of({kNan, 0, 0, 0, kInfinity, 0, 0, 0, -1e30F, 1e38F, 1e38F, 1e38F});
    downsampler.downsample(cloud);
    EXPECT_EQ(size(cloud), 4U);
  }
}

}  // namespace cloud_downsampler_test
}  // namespace nodmap::foxglove
