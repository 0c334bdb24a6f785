// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/plane_adjustment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace plane_adjustment_test {

using geometry::SE3;

constexpr std::size_t kSweeps = 5;

SE3 along(double x_m) {
  SE3 pose = SE3::Identity();
  pose.translation() << x_m, 0.0, 1.0;
  return pose;
}

using Noise = std::function<double()>;  // of a range, metres

// The sweep of a sphere of beams, 2 degrees apart, from a pose.
AdjustedSweep seen_from(
    const SE3& T_world_base, const Room& room, const Noise& noise = [] { return 0.0; }) {
  std::vector<Eigen::Vector3f> points;
  for (double pitch_deg = -79.0; pitch_deg < 80.0; pitch_deg += 2.0) {
    for (double yaw_deg = -179.0; yaw_deg < 180.0; yaw_deg += 2.0) {
      const double pitch = geometry::deg_to_rad(pitch_deg);
      const double yaw = geometry::deg_to_rad(yaw_deg);
      const Eigen::Vector3d beam(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw),
                                 std::sin(pitch));
      const double range_m = room.range_m(T_world_base.translation(), T_world_base.linear() * beam);
      if (range_m < 30.0) {
        points.push_back(((range_m + noise()) * beam).cast<float>());
      }
    }
  }
  const VoxelMap voxels = VoxelMap::from_points(points, Eigen::Vector3f::Zero(), {});
  return {.T_map_base = T_world_base,
          .points = adjusted_points(points, {}),
          .planes = voxels.select(0).points};
}

// Five sweeps 0.5 m apart at their true poses. Odometry reports the true motion; its standard
// deviation is `sigma` (m and rad).
std::vector<AdjustedSweep> drive(
    const Room& room, double sigma, const Noise& noise = [] { return 0.0; }) {
  std::vector<AdjustedSweep> sweeps;
  for (std::size_t k = 0; k < kSweeps; ++k) {
    AdjustedSweep& sweep =
        sweeps.emplace_back(seen_from(along(0.5 * static_cast<double>(k)), room, noise));
    sweep.from = k > 0 ? k - 1 : 0;
    sweep.T_from_this = along(0.0).inverse() * along(0.5);
    sweep.covariance = sigma * sigma * Matrix6d::Identity();
  }
  return sweeps;
}

// Disturbs all poses but the first, by some millimetres and up to 0.1 degrees.
void disturb(std::vector<AdjustedSweep>& sweeps) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (std::size_t k = 1; k < sweeps.size(); ++k) {
    SE3& pose = sweeps[k].T_map_base;
    pose.translation() += 5e-3 * Eigen::Vector3d(any(random), any(random), any(random));
    pose.linear() = geometry::rotation_of(geometry::deg_to_rad(0.1) *
                                          Eigen::Vector3d(any(random), any(random), any(random))) *
                    pose.linear();
  }
}

double error_m(const SE3& pose, std::size_t k) {
  return (pose.translation() - along(0.5 * static_cast<double>(k)).translation()).norm();
}

// Without noise all planes agree at the true poses. One step finds them, up to an error that the
// voxels cause. Odometry is exact, but does not help, because its standard deviation is 1 m.
TEST(PlaneAdjustment, FindsTheTruePosesInAHall) {
  std::vector<AdjustedSweep> sweeps = drive(Room::hall(), 1.0);
  disturb(sweeps);
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  ASSERT_EQ(adjusted.size(), kSweeps);
  EXPECT_TRUE(adjusted[0].isApprox(sweeps[0].T_map_base, 0.0));
  for (std::size_t k = 1; k < kSweeps; ++k) {
    EXPECT_GT(error_m(sweeps[k].T_map_base, k), 1e-3) << k;
    EXPECT_LT(error_m(adjusted[k], k), 1e-3) << k;
    EXPECT_LT(geometry::rotation_angle(adjusted[k]), geometry::deg_to_rad(0.02)) << k;
  }
}

// With 1 cm of noise most patches on walls consist of single points, and only the floor nearby is
// dense. Measured: an error of 1.63 mm; 2.88 mm without the first step's wider kernel.
TEST(PlaneAdjustment, ACentimetreOfNoiseLeavesMillimetres) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise_m(0.0, 0.01);
  double square_sum_m2 = 0.0;
  constexpr int kDrives = 10;
  for (int i = 0; i < kDrives; ++i) {
    std::vector<AdjustedSweep> sweeps = drive(Room::hall(), 1.0, [&] { return noise_m(random); });
    disturb(sweeps);
    const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
    for (std::size_t k = 1; k < kSweeps; ++k) {
      square_sum_m2 += std::pow(error_m(adjusted[k], k), 2);
    }
  }
  EXPECT_LT(std::sqrt(square_sum_m2 / (kDrives * (kSweeps - 1))), 1.25 * 1.63e-3);
}

// No plane determines the position along a bare corridor, but patches at its edges seem to. Sweeps
// that are 4 mm off across the corridor therefore slide along it. Measured: at most 16 mm, if each
// step of odometry has a standard deviation of 10 cm.
TEST(PlaneAdjustment, SweepsHardlySlideAlongABareCorridor) {
  std::vector<AdjustedSweep> sweeps = drive(Room::corridor(), 0.1);
  for (std::size_t k = 1; k < kSweeps; ++k) {
    sweeps[k].T_map_base.translation().y() += 0.004;
  }
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  for (std::size_t k = 1; k < kSweeps; ++k) {
    EXPECT_LT(error_m(adjusted[k], k), 1.25 * 0.0158) << k;
  }
}

// A sweep without planes of its own, as between keyframes, is corrected by the planes of the
// others. Its motion may be measured from any earlier sweep.
TEST(PlaneAdjustment, SweepsBetweenKeyframesFollowThePlanesOfTheKeyframes) {
  std::vector<AdjustedSweep> sweeps = drive(Room::hall(), 1.0);
  for (const std::size_t k : {1U, 3U}) {
    sweeps[k].planes.clear();
    sweeps[k + 1].from = k - 1;
    sweeps[k + 1].T_from_this = along(0.0).inverse() * along(1.0);
  }
  disturb(sweeps);
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  for (std::size_t k = 1; k < kSweeps; ++k) {
    EXPECT_LT(error_m(adjusted[k], k), 1e-3) << k;
    EXPECT_LT(geometry::rotation_angle(adjusted[k]), geometry::deg_to_rad(0.02)) << k;
  }
  // Without any plane the pose is that of odometry from `from`.
  std::vector<AdjustedSweep> blind = drive(Room{}, 0.1);
  blind[2].from = 0;
  blind[2].T_from_this = along(0.0).inverse() * along(1.2);
  EXPECT_NEAR(adjust_planes(blind, {}, {}, {})[2].translation().x(), 1.2, 1e-9);
}

// A robot that turns a corner sees next to nothing that it has seen before, so that one motion is
// by odometry alone, 5 cm off with a standard deviation of 2 cm. Later planes of both sides agree
// within a kernel that is as wide, though not within the kernel for the noise.
TEST(PlaneAdjustment, PlanesOutsideTheKernelCorrectAMotionThatIsUncertain) {
  std::vector<AdjustedSweep> sweeps = drive(Room::hall(), 1e-3);
  for (std::size_t k = 3; k < kSweeps; ++k) {
    sweeps[k].T_map_base.translation().x() += 0.05;
  }
  sweeps[3].T_from_this.translation().x() += 0.05;
  sweeps[3].covariance = 0.02 * 0.02 * Matrix6d::Identity();
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  for (std::size_t k = 1; k < kSweeps; ++k) {
    EXPECT_LT(error_m(adjusted[k], k), 1e-3) << k;
  }
}

// If all poses are moved by the same motion, so are the adjusted poses. There is a small
// difference, because the cubes of the patches lie elsewhere on the walls.
TEST(PlaneAdjustment, DoesNotDependOnTheMapFrame) {
  std::vector<AdjustedSweep> sweeps = drive(Room::hall(), 1.0);
  disturb(sweeps);
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  SE3 T_new_map = SE3::Identity();
  T_new_map.translation() << 12.37, -7.11, 3.29;
  T_new_map.linear() = geometry::rotation_of(Eigen::Vector3d(0.2, -0.1, 1.3));
  for (AdjustedSweep& sweep : sweeps) {
    sweep.T_map_base = T_new_map * sweep.T_map_base;
  }
  const std::vector<SE3> moved = adjust_planes(sweeps, {}, {}, {});
  for (std::size_t k = 0; k < kSweeps; ++k) {
    const SE3 difference = (T_new_map * adjusted[k]).inverse() * moved[k];
    EXPECT_LT(difference.translation().norm(), 1e-3) << k;
    EXPECT_LT(geometry::rotation_angle(difference), geometry::deg_to_rad(0.02)) << k;
  }
}

TEST(PlaneAdjustment, LevelGroundDeterminesTheHeightWithoutPlanes) {
  std::vector<AdjustedSweep> sweeps = drive(Room{}, 0.1);
  for (AdjustedSweep& sweep : sweeps) {
    sweep.level = {.height_m = 1.0, .ground = {.height_sigma_m = 1e-3, .tilt_sigma_rad = 1e-3}};
  }
  sweeps[2].T_map_base.translation().z() += 1e-3;
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  // The robust kernel reduces the weight by a fifth at one standard deviation, and the neighbours
  // constrain hardly anything.
  EXPECT_NEAR(adjusted[2].translation().z(), 1.0, 1e-5);
}

// Without common planes the poses are those of odometry. A single sweep stays where it is, and no
// sweep gives no pose.
TEST(PlaneAdjustment, WithoutCommonPlanesThePosesFollowOdometry) {
  EXPECT_TRUE(adjust_planes({}, {}, {}, {}).empty());
  std::vector<AdjustedSweep> sweeps = drive(Room{}, 0.1);
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  for (std::size_t k = 0; k < kSweeps; ++k) {
    EXPECT_LT(error_m(adjusted[k], k), 1e-12) << k;
  }
  sweeps.erase(sweeps.begin() + 1, sweeps.end());
  EXPECT_TRUE(adjust_planes(sweeps, {}, {}, {})[0].isApprox(sweeps[0].T_map_base, 0.0));
}

// A thin board: two sweeps see its front and one its back, 4 cm behind. The back is not taken for
// the front, so that odometry alone determines the pose of the third sweep.
TEST(PlaneAdjustment, TheBackOfAThinBoardIsNotItsFront) {
  std::vector<AdjustedSweep> sweeps(3);
  for (std::size_t k = 0; k < sweeps.size(); ++k) {
    sweeps[k].T_map_base = along(k < 2 ? 0.0 : 4.0);
    sweeps[k].T_from_this = sweeps[0].T_map_base.inverse() * sweeps[k].T_map_base;
    for (float y = -1.0F; y < 1.0F; y += 0.08F) {
      for (float z = -1.0F; z < 1.0F; z += 0.08F) {
        const Eigen::Vector3f p_base(k < 2 ? 2.0F : -1.96F, y, z);
        sweeps[k].points.push_back({p_base, 5.0F});
        if (k < 2) {
          sweeps[k].planes.push_back({p_base, -Eigen::Vector3f::UnitX(), 5.0F});
        }
      }
    }
  }
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  EXPECT_LT(geometry::distance_m(adjusted[2], along(4.0)), 1e-9);
}

// Each point counts once, in the mean of the points that fall into the same voxel. Points that are
// not finite are left out.
TEST(AdjustedPoints, AreTheMeansOfVoxels) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points{
      {0.01F, 0.02F, 0.03F}, {nan, 0.0F, 0.0F}, {0.03F, 0.04F, 0.07F}, {0.09F, 0.02F, 0.03F}};
  const auto means = adjusted_points(points, {.voxel_size_m = 0.08});
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[0].num_points, 2.0F);
  EXPECT_TRUE(means[0].p.isApprox(Eigen::Vector3f(0.02F, 0.03F, 0.05F)));  // float rounding
  EXPECT_EQ(means[1].num_points, 1.0F);
  EXPECT_TRUE(means[1].p.isApprox(points[3]));
  EXPECT_TRUE(adjusted_points({}, {}).empty());
}

// Equations that cannot be solved leave the poses as they are.
TEST(PlaneAdjustment, WithoutASolutionThePosesStay) {
  std::vector<AdjustedSweep> sweeps = drive(Room::hall(), 1.0);
  sweeps[2].covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const std::vector<SE3> adjusted = adjust_planes(sweeps, {}, {}, {});
  for (std::size_t k = 0; k < kSweeps; ++k) {
    EXPECT_TRUE(adjusted[k].isApprox(sweeps[k].T_map_base, 0.0)) << k;
  }
}

}  // namespace plane_adjustment_test
}  // namespace nodmap::slam6d
