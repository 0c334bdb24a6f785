// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/track.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace track_test {

using test::at;
using test::kScanS;

// Covariances of the motion model (a start and a velocity with errors, and white acceleration): of
// the positions at two times, and of a velocity with an earlier position.
double cov_pp(double t, double s) {
  const double first = std::min(t, s);
  const double last = std::max(t, s);
  return std::pow(Track::kPositionSigmaM, 2) + std::pow(Track::kVelocitySigmaMps, 2) * t * s +
         Track::kAccelerationDensity * first * first * (3.0 * last - first) / 6.0;
}
double cov_vp(double s) {
  return std::pow(Track::kVelocitySigmaMps, 2) * s + 0.5 * Track::kAccelerationDensity * s * s;
}

// Oracle: the state conditioned on all detections at once, as one Gaussian whose prior mean is the
// first detection. Tolerance: rounding.
TEST(Track, EqualsTheGaussianConditionedOnAllDetections) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise_m(0.0, 0.1);
  const std::vector<double> times_s{0.0, 0.013, 0.027, 0.3, 0.313, 0.6, 0.62, 1.1};
  std::vector<double> z;
  for (const double t : times_s) {
    z.push_back(2.0 - 1.1 * t + noise_m(random));
  }
  Track track(time::Timestamp{}, {{z[0], 0.0}, 0.25});
  for (std::size_t i = 1; i < z.size(); ++i) {
    track.predict(at(times_s[i]));
    track.update({{z[i], 0.0}, 0.25});
  }
  const auto n = static_cast<Eigen::Index>(z.size()) - 1;
  Eigen::MatrixXd S(n, n);
  Eigen::VectorXd innovation(n);
  Eigen::RowVectorXd p(n);
  Eigen::RowVectorXd v(n);
  const double t_end = times_s.back();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = times_s[static_cast<std::size_t>(i) + 1];
    innovation[i] = z[static_cast<std::size_t>(i) + 1] - z[0];
    p[i] = cov_pp(t_end, t);
    v[i] = cov_vp(t);
    for (Eigen::Index j = 0; j < n; ++j) {
      S(i, j) = cov_pp(t, times_s[static_cast<std::size_t>(j) + 1]) +
                (i == j ? std::pow(Track::kPositionSigmaM, 2) : 0.0);
    }
  }
  const Eigen::VectorXd weights = S.ldlt().solve(innovation);
  EXPECT_NEAR(track.person().position.x(), z[0] + p.dot(weights), 1e-9);
  EXPECT_NEAR(track.person().velocity.x(), v.dot(weights), 1e-9);
  const double variance = cov_pp(t_end, t_end) - p.dot(S.ldlt().solve(p.transpose()));
  EXPECT_NEAR(track.person().position_sigma_m, std::sqrt(variance), 1e-9);
}

// Oracle: the mean of two measurements, weighted by their variances. Tolerance: rounding.
TEST(Track, ASingleLegIsLessExactOnceBothHaveBeenSeen) {
  for (const int num_legs : {0, 1, 2}) {
    Track track(time::Timestamp{}, {{1.0, 0.0}, 0.25, 0.2, 0.4, 1.0, num_legs});
    track.update({{1.2, 0.0}, 0.15, 0.2, 0.4, 1.0, 1});
    const double first = std::pow(Track::kPositionSigmaM, 2);
    const double second =
        num_legs == 2 ? std::pow(Track::kLegSigmaM, 2) : std::pow(Track::kPositionSigmaM, 2);
    EXPECT_NEAR(track.person().position.x(), 1.0 + 0.2 * first / (first + second), 1e-12);
    EXPECT_EQ(track.person().radius_m == 0.25, num_legs == 2);
  }
}

TEST(Track, TheErrorGrowsBetweenSightings) {
  Track track(time::Timestamp{}, {{1.0, 0.0}, 0.25});
  double last_m = 0.0;
  for (double t = 0.0; t < 1.0; t += 0.1) {
    track.predict(at(t));
    EXPECT_GT(track.person().position_sigma_m, last_m);
    last_m = track.person().position_sigma_m;
  }
}

// A board at one height, hit by scan lines in one place after another, is not a person, however
// well these places fit a motion. Somebody who moves the same way and is measured at several
// heights is.
// A post that came into view where free space was assumed is no newcomer for ever: the robot would
// wait for it. Somebody who has walked and stops counts for two seconds more.
TEST(Track, WhatHasNotMovedForTwoSecondsIsNotNew) {
  Track post(at(0.0), {.p_odom = {2.0, 0.0}, .radius_m = 0.1, .free_ratio = 1.0}, 0, true);
  for (double t = 0.1; t < 5.0; t += 0.1) {
    post.predict(at(t));
    post.update({.p_odom = {2.0, 0.0}, .radius_m = 0.1, .free_ratio = 1.0});
    EXPECT_EQ(post.is_new(), t > 0.15 && t < 1.95) << t;
  }
  const auto x_m = [](double t) { return 2.0 + std::min(t, 3.0); };  // walks for 3 s
  Track walker(at(0.0), {.p_odom = {2.0, 0.0}, .radius_m = 0.25, .free_ratio = 1.0}, 0, true);
  double was_walking_s = 0.0;
  for (double t = 0.1; t < 8.0; t += 0.1) {
    walker.predict(at(t));
    walker.update({.p_odom = {x_m(t), 0.0}, .radius_m = 0.25, .free_ratio = 1.0});
    was_walking_s = walker.moves() ? t : was_walking_s;
    if (t > 1.0) {
      EXPECT_EQ(walker.moves() || walker.is_new(), t - was_walking_s < 1.95) << t;
    }
  }
  EXPECT_GT(was_walking_s, 3.0);
}

TEST(Track, AnObjectMeasuredAtOneHeightIsNotAPerson) {
  for (const double height_m : {0.04, 0.3}) {
    Track track(time::Timestamp{}, {{2.0, 0.0}, 0.25, 0.44, 0.44});
    for (int i = 1; i < 60; ++i) {
      const double time_s = kScanS * i;
      track.predict(at(time_s));
      const double low_m = 0.44 - height_m * (i % 6) / 5.0;
      track.update({{2.0 - 1.0 * time_s, 0.0}, 0.25, low_m, low_m});
      if (i == 8) {
        EXPECT_EQ(track.is_new(), height_m > 0.1);
      }
    }
    EXPECT_EQ(track.moves(), height_m > 0.1);
  }
}

}  // namespace track_test
}  // namespace nodmap::navigator
