// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::evaluate {
namespace trajectory_error_test {

using geometry::SE3;
using geometry::to_se3;

constexpr time::Duration kSecond = 1s;

// A drive along a circle with one pose per second.
formats::Trajectory circle(int num_poses) {
  formats::Trajectory trajectory;
  for (int i = 0; i < num_poses; ++i) {
    const double angle = 0.1 * i;
    trajectory.push_back({time::Timestamp(i * kSecond),
                          to_se3({5.0 * std::sin(angle), 5.0 - 5.0 * std::cos(angle), angle})});
  }
  return trajectory;
}

const SE3 kElsewhere = geometry::make_se3(
    {7.0, -2.0, 1.0},
    Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 1, 3).normalized())));

formats::Trajectory moved(const SE3& T_a_b, formats::Trajectory trajectory) {
  for (auto& stamped : trajectory) {
    stamped.pose = T_a_b * stamped.pose;
  }
  return trajectory;
}

// A robot that is LOST for a while, at the end, or at the start gives no pose meanwhile.
TEST(TrajectoryError, TheLongestGapIsThatInTheEstimate) {
  const formats::Trajectory truth = circle(41);
  EXPECT_EQ(longest_gap_s(truth, truth), 1.0);
  formats::Trajectory without_middle = truth;
  without_middle.erase(without_middle.begin() + 11, without_middle.begin() + 30);
  EXPECT_EQ(longest_gap_s(without_middle, truth), 20.0);  // from 10 s to 30 s
  EXPECT_EQ(longest_gap_s(circle(16), truth), 25.0);
  EXPECT_EQ(longest_gap_s(without_middle, circle(16)), 5.0);  // the truth ends first
  EXPECT_EQ(longest_gap_s({truth.rbegin(), truth.rend() - 30}, truth), 30.0);
  EXPECT_EQ(longest_gap_s({}, truth), 40.0);
}

// The positions of a straight drive do not tell how it is rotated about its own line.
TEST(TrajectoryError, AStraightDriveIsNotAlignedUpsideDown) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise_m(0.0, 0.002);
  for (int run = 0; run < 20; ++run) {
    formats::Trajectory truth;
    formats::Trajectory estimate;
    for (int i = 0; i < 100; ++i) {
      truth.push_back({time::Timestamp(i * kSecond), to_se3({0.2 * i, 0.0, 0.0})});
      estimate.push_back(truth.back());
      estimate.back().pose.translation() +=
          Eigen::Vector3d(noise_m(random), noise_m(random), noise_m(random));
    }
    const auto errors = measure_trajectory(
        associate(moved(to_se3({3.0, 1.0, 0.7}), estimate), truth, 0s), Alignment::kMinSquares);
    // The heading of a line of 20 m through 100 points, each 2 mm off: 3.5e-5 rad; five times that.
    EXPECT_LT(errors.rot_rmse_rad, 1.8e-4);
    EXPECT_LT(errors.ate_rmse_m, 0.005);  // 2 mm in each of three directions: 3.5 mm
  }
}

TEST(TrajectoryError, IsZeroForTheTruthInAnotherFrame) {
  const auto pairs = associate(moved(kElsewhere, circle(40)), circle(40), 0s);
  ASSERT_EQ(pairs.size(), 40U);
  for (const Alignment alignment : {Alignment::kFirstPose, Alignment::kMinSquares}) {
    const TrajectoryErrors errors = measure_trajectory(pairs, alignment);
    EXPECT_LT(errors.ate_max_m, 1e-9);     // rounding of a singular value decomposition at 10 m
    EXPECT_LT(errors.rot_rmse_rad, 1e-7);  // an angle near zero: square root of rounding
    EXPECT_LT(*errors.drift_percent, 1e-9);
  }
}

TEST(TrajectoryError, ErrorsAreAsComputedByHand) {
  // Three poses along x; the estimate is 0.3 m to the left at the second, and 0.4 m and rotated at
  // the third.
  const std::vector<PosePair> pairs = {{to_se3({0.0, 0.0, 0.0}), to_se3({0.0, 0.0, 0.0}), 3.0},
                                       {to_se3({5.0, 0.3, 0.0}), to_se3({5.0, 0.0, 0.0}), 8.0},
                                       {to_se3({10.0, 0.4, 0.3}), to_se3({10.0, 0.0, 0.0}), 13.0}};
  const TrajectoryErrors errors = measure_trajectory(pairs, Alignment::kFirstPose);
  EXPECT_EQ(errors.n, 3U);
  EXPECT_NEAR(errors.ate_rmse_m, 0.5 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(errors.ate_max_m, 0.4, 1e-12);
  EXPECT_NEAR(errors.rot_rmse_rad, 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(*errors.drift_percent, 4.0, 1e-12);
}

// A circle of 10 m with 100 true poses, of which the estimate has every third from the second on;
// the last is 0.3 m off.
TEST(TrajectoryError, DriftIsInPercentOfTheTruePathHoweverSparseTheEstimateIs) {
  const formats::Trajectory truth = circle(100);
  formats::Trajectory estimate;
  for (std::size_t i = 1; i < truth.size(); i += 3) {
    estimate.push_back(truth[i]);
  }
  estimate.back().pose.translation().z() += 0.3;
  const double chord_m = 2.0 * 5.0 * std::sin(0.05);
  const TrajectoryErrors errors =
      measure_trajectory(associate(estimate, truth, 0s), Alignment::kFirstPose);
  EXPECT_NEAR(*errors.drift_percent, 100.0 * 0.3 / (96 * chord_m), 1e-9);
}

TEST(TrajectoryError, LeastSquaresIsNeverWorseAndForgivesABadStart) {
  formats::Trajectory estimate = circle(60);
  std::mt19937 random(2);
  std::normal_distribution<double> noise_m(0.0, 0.05);
  for (auto& stamped : estimate) {
    stamped.pose.translation() += Eigen::Vector3d(noise_m(random), noise_m(random), 0.0);
  }
  estimate.front().pose = estimate.front().pose * to_se3({0.0, 0.0, 0.2});
  const auto pairs = associate(moved(kElsewhere, estimate), circle(60), 0s);
  const TrajectoryErrors first = measure_trajectory(pairs, Alignment::kFirstPose);
  const TrajectoryErrors best = measure_trajectory(pairs, Alignment::kMinSquares);
  EXPECT_GT(first.ate_rmse_m, 0.5);  // 0.2 rad at up to 10 m
  EXPECT_LT(best.ate_rmse_m, 0.1);   // two axes of 0.05 m
  EXPECT_EQ(first.drift_percent, best.drift_percent);
}

TEST(TrajectoryError, InterpolatesTheTruth) {
  const formats::Trajectory truth = {{time::Timestamp(0s), to_se3({0.0, 0.0, 0.0})},
                                     {time::Timestamp(100ms), to_se3({1.0, 0.0, 0.2})}};
  const auto pairs = associate({{time::Timestamp(25ms), to_se3({})}}, truth, 50ms);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_TRUE(pairs[0].T_truth_base.isApprox(to_se3({0.25, 0.0, 0.05}), 1e-12));
}

TEST(TrajectoryError, AssociatesWithinToleranceOnly) {
  const formats::Trajectory truth = {{time::Timestamp(2 * kSecond), to_se3({2.0, 0.0, 0.0})},
                                     {time::Timestamp(1 * kSecond), to_se3({1.0, 0.0, 0.0})},
                                     {time::Timestamp(1 * kSecond), to_se3({9.0, 0.0, 0.0})}};
  const auto partners = [&](time::Timestamp stamp) {
    return associate({{stamp, to_se3({})}}, truth, 50ms);
  };
  EXPECT_EQ(partners(time::from_utime(949'999)).size(), 0U);
  EXPECT_EQ(partners(time::from_utime(950'000)).size(), 1U);  // before the first: the first
  EXPECT_EQ(partners(time::from_utime(1'500'000)).size(), 0U);
  EXPECT_EQ(partners(time::from_utime(2'050'000)).size(), 1U);
  EXPECT_EQ(partners(time::from_utime(2'050'001)).size(), 0U);
  EXPECT_EQ(partners(time::from_utime(1'000'000))[0].T_truth_base.translation().x(),
            1.0);  // the first of two
}

TEST(TrajectoryError, HandlesEmptyTrajectoriesAndSinglePoses) {
  EXPECT_TRUE(associate({}, circle(3), 0s).empty());
  EXPECT_TRUE(associate(circle(3), {}, 0s).empty());
  EXPECT_EQ(measure_trajectory({}, Alignment::kMinSquares).n, 0U);
  for (const Alignment alignment : {Alignment::kFirstPose, Alignment::kMinSquares}) {
    const TrajectoryErrors one = measure_trajectory({{kElsewhere, to_se3({})}}, alignment);
    EXPECT_LT(one.ate_max_m, 1e-9);
    EXPECT_FALSE(one.drift_percent);  // no path, no percent of it
  }
}

}  // namespace trajectory_error_test
}  // namespace nodmap::evaluate
