// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/registration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "modules/slam6d/registration/heading_search.hpp"
#include "modules/slam6d/test/room.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"

namespace nodmap::slam6d {
namespace registration_test {

using geometry::deg_to_rad;
using geometry::SE3;

// Errors are compared with those that were measured: noise has fixed seeds, so only another
// compiler or another algorithm changes them.
constexpr double kMargin = 1.25;

const Eigen::Vector3f kMirror(0.1F, 0.0F, 0.4F);

// A sweep of a stationary scanner at a pose, in base; the ranges have 1 cm of noise. `step_deg`:
// the pitch from scan to scan.
VoxelMap see(const Room& room, const SE3& T_world_base, unsigned seed, double step_deg = 1.0) {
  std::mt19937 random(seed);
  const NoddingScanner scanner{.step_rad = deg_to_rad(step_deg), .noise_m = 0.01};
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < static_cast<int>(80.0 / step_deg); ++i) {
    const scan::Scan scan = scanner.scan(
        i, room, [&](time::Timestamp) { return T_world_base; }, random);
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
      if (scan.ranges_m[beam] < 15.0F) {
        points.push_back(
            point_in_base(scan, beam, static_cast<double>(scan.ranges_m[beam])).cast<float>());
      }
    }
  }
  return VoxelMap::from_points(points, kMirror, {});
}

VoxelMap map_of(const Room& room, double step_deg = 1.0) {
  VoxelMap map{VoxelMapParams{}};
  map.add_sweep(see(room, SE3::Identity(), 1, step_deg), SE3::Identity());
  return map;
}

SE3 pose(double x, double y, double z, double roll_deg, double pitch_deg, double yaw_deg) {
  const Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(deg_to_rad(yaw_deg), Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(deg_to_rad(pitch_deg), Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(deg_to_rad(roll_deg), Eigen::Vector3d::UnitX());
  return geometry::make_se3({x, y, z}, rotation);
}

// A prior with standard deviations of 0.2 m and 5 degrees in each direction.
PosePrior loose_prior(const SE3& T_map_base) {
  PosePrior prior{T_map_base, Matrix6d::Zero()};
  prior.covariance.diagonal() << Eigen::Vector3d::Constant(0.04),
      Eigen::Vector3d::Constant(std::pow(deg_to_rad(5.0), 2));
  return prior;
}

Registration registered(VoxelMap sweep, const VoxelMap& map, const PosePrior& prior,
                        const RegistrationParams& params) {
  return register_sweep(sweep, map, prior, params);
}

SE3 error_of(const Registration& registration, const SE3& T_truth) {
  return T_truth.inverse() * registration.T_map_base;
}

// R44. Averaged over some thousand points, 1 cm of noise leaves an error of about a millimetre.
TEST(Registration, R44_FindsSixDegreesOfFreedomInAHall) {
  const Room room = Room::hall();
  const SE3 T_truth = pose(0.8, -0.2, 0.05, 1.0, -2.0, 12.0);
  const SE3 T_guess = T_truth * pose(0.15, 0.1, -0.05, 1.0, 1.0, -4.0);
  const Registration found =
      registered(see(room, T_truth, 2), map_of(room), loose_prior(T_guess), {});
  ASSERT_EQ(found.state, PoseState::kTracking);
  EXPECT_EQ(found.degenerate_directions, 0);
  EXPECT_GT(found.inlier_ratio, 0.5);
  EXPECT_LT(found.residual_rms_m, kMargin * 0.0051);
  EXPECT_LT(error_of(found, T_truth).translation().norm(), kMargin * 0.0026);
  EXPECT_LT(geometry::rotation_angle(error_of(found, T_truth)), deg_to_rad(kMargin * 0.05));
  // The error is within four standard deviations of the covariance.
  const double sigma_m = std::sqrt(found.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT(error_of(found, T_truth).translation().norm(), 4.0 * sigma_m);
  EXPECT_LT(sigma_m, kMargin * 0.0028);
}

// A fast robot sweeps in coarse steps; when it slows down, the steps become fine. A fine sweep has
// planes in the smallest voxels, where the map has too few points for any: it lies on the map's
// coarser planes. These reach far, but at a wrong heading the walls lie on none.
TEST(Registration, AFineSweepFitsAMapOfCoarseSweepsAtTheRightHeadingOnly) {
  const VoxelMap map = map_of(Room::hall(), 3.0);
  const SE3 T_truth = pose(0.8, -0.2, 0.0, 0.0, 0.0, 6.0);
  const VoxelMap sweep = see(Room::hall(), T_truth, 2, 0.5);
  const SE3 T_guess = T_truth * pose(0.1, 0.05, -0.02, 0.5, 0.5, -2.0);
  const Registration found = registered(sweep, map, loose_prior(T_guess), {});
  ASSERT_EQ(found.state, PoseState::kTracking);
  EXPECT_GT(found.lowest_inlier_ratio(), 0.5);  // both see the same surfaces, apart from edges
  EXPECT_LT(error_of(found, T_truth).translation().norm(), kMargin * 0.0104);
  EXPECT_LT(geometry::rotation_angle(error_of(found, T_truth)), deg_to_rad(kMargin * 0.134));
  for (const double off_deg : {20.0, 45.0, 90.0, 180.0}) {
    PosePrior prior = loose_prior(T_truth * pose(0.0, 0.0, 0.0, 0.0, 0.0, off_deg));
    prior.covariance *= 0.01;
    EXPECT_FALSE(registered(sweep, map, prior, {}).is_accepted()) << off_deg;
  }
}

// The result does not depend on the guess: eight guesses lead to the same pose, within about the
// 0.1 mm at which the iteration ends.
TEST(Registration, EveryGuessWithinReachLeadsToTheSamePose) {
  const Room room = Room::hall();
  const VoxelMap map = map_of(room);
  const SE3 T_truth = pose(0.4, 0.2, 0.0, 0.0, 0.0, -8.0);
  const VoxelMap sweep = see(room, T_truth, 3);
  const SE3 reference = registered(sweep, map, loose_prior(T_truth), {}).T_map_base;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto sign = [&](unsigned bit) { return (corner & bit) != 0 ? 1.0 : -1.0; };
    const SE3 T_guess = T_truth * pose(0.15 * sign(1), 0.15 * sign(2), 0.05 * sign(4), sign(1),
                                       -sign(2), 4.0 * sign(4));
    const Registration found = registered(sweep, map, loose_prior(T_guess), {});
    EXPECT_LT((reference.inverse() * found.T_map_base).translation().norm(), kMargin * 1.3e-4)
        << corner;
  }
}

// With the paper's point pairs the pose is less exact, because scan lines attract each other.
TEST(Registration, R44_ThePapersMetricIsRightToTwoCentimetres) {
  const Room room = Room::hall();
  const SE3 T_truth = pose(0.5, 0.1, 0.0, 0.0, 0.0, 5.0);
  const SE3 T_guess = T_truth * pose(0.1, 0.05, 0.02, 0.5, 0.5, -2.0);
  const Registration found =
      registered(see(room, T_truth, 3), map_of(room), loose_prior(T_guess),
                 {.metric = ErrorMetric::kPointToPoint, .iterations_per_level = 60});
  ASSERT_TRUE(found.is_accepted());
  EXPECT_LT(error_of(found, T_truth).translation().norm(), kMargin * 0.019);
  EXPECT_LT(geometry::rotation_angle(error_of(found, T_truth)), deg_to_rad(kMargin * 0.45));
}

// Close to a wall the only level surface is a strip of floor. It is too narrow to be a plane in
// coarse voxels, and at first too far from the map's strip for fine ones. Its correspondences are
// found along its normals.
TEST(Registration, R44_AStripOfFloorDeterminesTheHeight) {
  const Room room{{{{0, 0, 1}, -0.6}, {{0, 1, 0}, 1.2}, {{0, 1, 0}, -1.2}, {{1, 0, 0}, 1.45}}};
  const VoxelMap map = map_of(room);
  const SE3 T_truth = pose(0.02, 0.05, 0.0, 0.0, 0.0, 3.0);
  const VoxelMap sweep = see(room, T_truth, 2);
  for (const double off_m : {-0.25, 0.25}) {
    const SE3 T_guess = T_truth * pose(0.05, 0.0, off_m, 1.0, -1.0, -2.0);
    const Registration found = registered(sweep, map, loose_prior(T_guess), {});
    ASSERT_EQ(found.state, PoseState::kTracking) << off_m;
    // A few dozen planes with 1 cm of noise.
    EXPECT_LT(error_of(found, T_truth).translation().norm(), kMargin * 0.003) << off_m;
    EXPECT_LT(geometry::rotation_angle(error_of(found, T_truth)), deg_to_rad(kMargin * 0.048))
        << off_m;
  }
}

// R37, R44: nothing determines the position along an endless corridor, so that it stays at the
// guess, which comes from odometry. The other five directions are found.
TEST(Registration, R37_ACorridorKeepsOdometryAlongItsAxis) {
  const Room room = Room::corridor();
  const SE3 T_truth = pose(1.0, 0.1, 0.0, 0.0, 0.0, 3.0);
  SE3 T_guess = T_truth * pose(0.0, 0.0, 0.03, 0.5, -0.5, -2.0);
  T_guess.translation() = Eigen::Vector3d(1.2, 0.0, 0.02);
  const Registration found =
      registered(see(room, T_truth, 4), map_of(room), loose_prior(T_guess), {});
  ASSERT_EQ(found.state, PoseState::kDegraded);
  EXPECT_EQ(found.degenerate_directions, 1);
  EXPECT_NEAR(found.T_map_base.translation().x(), 1.2, kMargin * 4e-4);
  EXPECT_NEAR(found.T_map_base.translation().y(), 0.1, kMargin * 4e-4);
  EXPECT_NEAR(found.T_map_base.translation().z(), 0.0, kMargin * 4.3e-4);
  EXPECT_LT(geometry::rotation_angle(error_of(found, T_truth)), deg_to_rad(kMargin * 0.0095));
  // The covariance shows it: along the corridor the standard deviation is the prior's 0.2 m, across
  // it millimetres.
  EXPECT_GT(std::sqrt(found.covariance(0, 0)), 0.1);
  EXPECT_LT(std::sqrt(found.covariance(1, 1)), kMargin * 0.0016);
}

// Only the floor is seen: it determines height, roll and pitch, while x, y and yaw come from
// odometry.
TEST(Registration, R44_ABareFloorKeepsOdometryInItsPlane) {
  const Room floor{{{{0, 0, 1}, 0.0}}};
  const SE3 T_guess = pose(0.6, 0.4, 0.05, 1.0, -1.0, 10.0);
  const Registration found = registered(see(floor, pose(0.5, 0.5, 0, 0, 0, 12.0), 5), map_of(floor),
                                        loose_prior(T_guess), {});
  ASSERT_EQ(found.state, PoseState::kDegraded);
  EXPECT_EQ(found.degenerate_directions, 3);
  EXPECT_NEAR(found.T_map_base.translation().x(), 0.6, kMargin * 4e-4);
  EXPECT_NEAR(found.T_map_base.translation().y(), 0.4, kMargin * 4e-4);
  EXPECT_NEAR(found.T_map_base.translation().z(), 0.0, kMargin * 5.1e-4);
  EXPECT_NEAR(geometry::to_se2(found.T_map_base).yaw, deg_to_rad(10.0),
              deg_to_rad(kMargin * 0.009));
  EXPECT_GT(found.T_map_base.linear()(2, 2), std::cos(deg_to_rad(kMargin * 0.03)));
}

// During a sweep odometry counts 5 cm and 3 degrees too much. Registration corrects the motion
// within the sweep along with the pose.
TEST(Registration, R41_TheMotionWithinASweepIsCorrected) {
  const Room room = Room::hall();
  const NoddingScanner scanner{.noise_m = 0.01};
  std::mt19937 random(8);
  const auto drive = [](time::Timestamp t) {
    return drive_ahead(0.5, t) * pose(0, 0, 0, 0, 0, 30.0 * time::seconds(t.time_since_epoch()));
  };
  const auto odometry = [](time::Timestamp t) {
    return drive_ahead(0.547, t) * pose(0, 0, 0, 0, 0, 32.8 * time::seconds(t.time_since_epoch()));
  };
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 80; ++i) {
    scans.push_back(scanner.scan(i, room, drive, random));
  }
  SweepCloud cloud = deskew(scans, odometry, {.max_m = 15.0}).value();
  PointTimes times{{}, cloud.half_path().cast<float>()};
  for (const SweepCloud::Line& line : cloud.lines) {
    times.times.resize(line.end, static_cast<float>(line.time));
  }
  VoxelMap sweep = VoxelMap::from_points(cloud.points, kMirror, {}, times);
  const SE3 T_truth = drive(cloud.stamp);
  PosePrior prior = loose_prior(odometry(cloud.stamp));
  prior.motion_covariance = prior.covariance;
  const Registration found = register_sweep(sweep, map_of(room), prior, {});
  ASSERT_EQ(found.state, PoseState::kTracking);
  cloud.correct(found.correction);
  const time::Timestamp end(79 * NoddingScanner::kPeriod + NoddingScanner::kPeriod / 2);
  const SE3 motion_error =
      (drive(time::Timestamp{}).inverse() * drive(end)).inverse() * cloud.motion();
  EXPECT_LT(error_of(found, T_truth).translation().norm(), kMargin * 0.0045);
  EXPECT_LT(geometry::rotation_angle(error_of(found, T_truth)), deg_to_rad(kMargin * 0.066));
  EXPECT_LT(motion_error.translation().norm(), kMargin * 0.0037);
  EXPECT_LT(geometry::rotation_angle(motion_error), deg_to_rad(kMargin * 0.18));
}

// A sweep of a robot that drives ahead at 0.5 m/s, while its heading, by `heading_deg`, changes
// within the second that it takes. Odometry counts the distance alone.
struct TurningRobot {
  std::function<double(double)> heading_deg;

  [[nodiscard]] SE3 T_world_base(time::Timestamp t) const {
    return drive_ahead(0.5, t) *
           pose(0, 0, 0, 0, 0, heading_deg(time::seconds(t.time_since_epoch())));
  }

  [[nodiscard]] SweepCloud cloud() const {
    const Room room = Room::hall();
    const NoddingScanner scanner{.noise_m = 0.01};
    std::mt19937 random(8);
    std::vector<scan::Scan> scans;
    for (int i = 0; i < 80; ++i) {
      scans.push_back(scanner.scan(
          i, room, [this](time::Timestamp t) { return T_world_base(t); }, random));
    }
    return deskew(scans, [](time::Timestamp t) { return drive_ahead(0.5, t); }, {.max_m = 15.0})
        .value();
  }

  static Registration registered(const SweepCloud& cloud, const RegistrationParams& params) {
    VoxelMap sweep = voxelize(cloud, {});
    PosePrior prior = loose_prior(drive_ahead(0.5, cloud.stamp));
    prior.motion_covariance = prior.covariance;
    return register_sweep(sweep, map_of(Room::hall()), prior, params);
  }
};

// The heading swings by 0.5 degrees to either side. In the middle of the sweep it is 0.5 degrees
// off that of a steady rotation.
TEST(Registration, R41_ASwingOfTheHeadingWithinASweepIsFound) {
  const TurningRobot robot{[](double t) { return 0.5 * std::cos(2.0 * geometry::kPi * t); }};
  SweepCloud cloud = robot.cloud();
  const SE3 T_truth = robot.T_world_base(cloud.stamp);
  const Registration steady = TurningRobot::registered(cloud, {.bend_rad = 0.0});
  const Registration bent = TurningRobot::registered(cloud, {});
  const double steady_rad = geometry::rotation_angle(error_of(steady, T_truth));
  const double bent_rad = geometry::rotation_angle(error_of(bent, T_truth));
  EXPECT_LT(bent_rad, 0.75 * steady_rad);
  cloud.correct(bent.correction);
  EXPECT_EQ(bent.correction.bend_rad.col(kBendKnots / 2), Eigen::Vector3d::Zero());
  EXPECT_EQ(steady.correction.bend_rad, Bend::Zero());
}

// The heading swings by half a degree and back. Odometry, with a standard deviation of 0.1 degrees,
// is right at the first and the last beam, but not in the middle, where the pose is. If it were
// compared with the middle, the result would be as many standard deviations away as the middle is.
TEST(Registration, R41_ASwingWithinASweepDoesNotContradictOdometry) {
  const TurningRobot robot{
      [](double t) { return 0.25 * (std::cos(2.0 * geometry::kPi * t) - 1.0); }};
  const SweepCloud cloud = robot.cloud();
  VoxelMap sweep = voxelize(cloud, {});
  PosePrior prior = loose_prior(drive_ahead(0.5, cloud.stamp));
  const double sigma_rad = deg_to_rad(0.1);
  prior.covariance.diagonal().tail<3>().setConstant(sigma_rad * sigma_rad);
  prior.motion_covariance = prior.covariance;
  const Registration found = register_sweep(sweep, map_of(Room::hall()), prior, {});
  ASSERT_EQ(found.state, PoseState::kTracking);
  const double middle_rad = geometry::rotation_angle(prior.T_map_base.inverse() * found.T_map_base);
  const double middle_sigma_rad = std::hypot(1.0, 0.5) * sigma_rad;  // half of the motion later
  EXPECT_GT(middle_rad, 3.0 * middle_sigma_rad);
  EXPECT_LT(found.prior_distance, 0.75 * middle_rad / middle_sigma_rad);
}

// Odometry does not count a rotation by 4 degrees: the wheels slip. However far odometry is
// believed (`slip_deg`), the rotation is found. A sweep tells the motion within it to 0.1 degrees.
TEST(Registration, R41_ARotationThatOdometryMissesIsFound) {
  const auto found_deg = [](double true_deg, double slip_deg) {
    const TurningRobot robot{[true_deg](double t) { return 2.0 * true_deg * (t - 0.5); }};
    const Registration found =
        TurningRobot::registered(robot.cloud(), {.slip_rad = deg_to_rad(slip_deg)});
    return geometry::rad_to_deg(found.correction.rotation_rad.z());
  };
  EXPECT_NEAR(found_deg(0.2, 360.0), 0.2, kMargin * 0.1);
  EXPECT_NEAR(found_deg(2.0, 0.02), 2.0, kMargin * 0.15);
}

// The prior says that the ground is level. A sweep that shows a ramp of 6 degrees overrules it; a
// sweep in which only a wall is seen does not.
TEST(Registration, TheGroundIsTakenAsLevelUnlessTheSweepContradicts) {
  const Room room = Room::hall();
  PosePrior prior = loose_prior(SE3::Identity());
  prior.level =
      PosePrior::Level{.ground = {.height_sigma_m = 0.005, .tilt_sigma_rad = deg_to_rad(0.1)}};
  const SE3 T_ramp = pose(0.3, 0.0, 0.08, 0.0, -6.0, 2.0);
  const Registration on_ramp = registered(see(room, T_ramp, 4), map_of(room), prior, {});
  ASSERT_EQ(on_ramp.state, PoseState::kTracking);
  EXPECT_LT(error_of(on_ramp, T_ramp).translation().norm(), kMargin * 0.0034);
  EXPECT_LT(geometry::rotation_angle(error_of(on_ramp, T_ramp)), deg_to_rad(kMargin * 0.078));
  // If only a wall ahead is seen, the prior determines height, roll and pitch.
  const SE3 T_tilted = pose(0.0, 0.0, 0.004, 0.05, 0.05, 0.0);
  const Room far_wall{{{{1, 0, 0}, 6.0}}};
  prior.T_map_base = T_tilted;
  const Registration held =
      registered(see(far_wall, SE3::Identity(), 4), map_of(far_wall), prior, {});
  EXPECT_LT(std::abs(held.T_map_base.translation().z()), 0.001);
  EXPECT_GT(held.T_map_base.linear()(2, 2), std::cos(deg_to_rad(0.02)));
}

// A pose that fits the map but is too far from odometry is refused: it might be the next bay of a
// hall with equal bays.
TEST(Registration, APoseTooFarFromThePriorIsRefused) {
  const Room room = Room::hall();
  const SE3 T_truth = pose(0.3, 0.0, 0.0, 0.0, 0.0, 6.0);
  const PosePrior prior = loose_prior(SE3::Identity());
  const VoxelMap sweep = see(room, T_truth, 7);
  const VoxelMap map = map_of(room);
  const Registration accepted = registered(sweep, map, prior, {});
  ASSERT_EQ(accepted.state, PoseState::kTracking);
  // In closed form: 0.3 m with a standard deviation of 0.2 m, and 6 degrees with one of 5 degrees.
  EXPECT_NEAR(accepted.prior_distance, std::hypot(1.5, 1.2), kMargin * 0.0075);
  const Registration refused = registered(sweep, map, prior, {.max_prior_distance = 1.5});
  EXPECT_EQ(refused.state, PoseState::kLost);
  EXPECT_EQ(refused.T_map_base.matrix(), SE3::Identity().matrix());
  EXPECT_EQ(refused.covariance, prior.covariance);
}

TEST(Registration, WithoutCorrespondencesTheRobotIsLostAndTheGuessIsKept) {
  const Room room = Room::hall();
  const VoxelMap sweep = see(room, SE3::Identity(), 6);
  const VoxelMap empty{VoxelMapParams{}};
  const VoxelMap map = map_of(room);
  const SE3 T_guess = pose(100, 0, 0, 0, 0, 0);
  for (const ErrorMetric metric : {ErrorMetric::kPointToPoint, ErrorMetric::kPointToPlane}) {
    const RegistrationParams params{.metric = metric};
    const Registration far = registered(sweep, map, loose_prior(T_guess), params);
    EXPECT_EQ(far.state, PoseState::kLost);
    EXPECT_EQ((far.T_map_base.matrix() - T_guess.matrix()).norm(), 0.0);
    const VoxelMap nothing = VoxelMap::from_points({}, kMirror, {});
    EXPECT_EQ(registered(nothing, map, loose_prior(T_guess), params).state, PoseState::kLost);
    EXPECT_EQ(registered(sweep, empty, loose_prior(T_guess), params).state, PoseState::kLost);
  }
}

// A prior with a covariance that is zero in one direction or not finite is handled: the result is
// not accepted.
TEST(Registration, WithAnInvalidPriorTheRobotIsLost) {
  const Room room = Room::hall();
  PosePrior prior = loose_prior(SE3::Identity());
  prior.covariance(2, 2) = 0.0;
  EXPECT_FALSE(registered(see(room, SE3::Identity(), 6), map_of(room), prior, {}).is_accepted());
  prior.covariance(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(registered(see(room, SE3::Identity(), 6), map_of(room), prior, {}).is_accepted());
}

}  // namespace registration_test
}  // namespace nodmap::slam6d
