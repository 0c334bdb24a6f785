// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/keyframe_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace nodmap::slam6d {
namespace keyframe_graph_test {

using geometry::SE3;

constexpr LevelGround kGround = {.height_sigma_m = 0.005, .tilt_sigma_rad = 0.002};

Matrix6d information(double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

// The poses of three rounds on a circle with a circumference of 25 m, with a keyframe for each
// metre.
std::vector<SE3> rounds() {
  std::vector<SE3> poses;
  for (int k = 0; k < 75; ++k) {
    const double angle = k / 4.0;
    SE3 T = SE3::Identity();
    T.translation() = Eigen::Vector3d(4.0 * std::sin(angle), -4.0 * std::cos(angle), 0.0);
    T.linear() = geometry::rotation_of({0.0, 0.0, angle});
    poses.push_back(T);
  }
  return poses;
}

// Each step drifts by 2 % and 0.3 degrees. There are 50 correct loop closures and 22 (30 % of all)
// that are metres off. The poses are compared with those of the same graph without the wrong ones.
TEST(KeyframeGraph, WrongLoopClosuresDoNotMoveTheKeyframes) {
  const std::vector<SE3> truth = rounds();
  SE3 step_error = SE3::Identity();
  step_error.translation().x() = 0.02;
  step_error.linear() = geometry::rotation_of({0.0, 0.0, 0.005});
  KeyframeGraph graph(kGround);
  std::vector<SE3> start{truth[0]};
  graph.add_keyframe(true);
  for (std::size_t k = 1; k < truth.size(); ++k) {
    const SE3 step = truth[k - 1].inverse() * truth[k] * step_error;
    start.push_back(start.back() * step);
    graph.add_keyframe(true);
    graph.add_step(
        {.from = k - 1, .to = k, .T_from_to = step, .information = information(0.02, 0.005)});
  }
  const Matrix6d loop_information = information(0.005, 0.001);
  const auto add_loop = [&](std::size_t from, std::size_t to, const SE3& error) {
    graph.add_loop({.from = from,
                    .to = to,
                    .T_from_to = truth[from].inverse() * truth[to] * error,
                    .information = loop_information,
                    .may_be_wrong = true});
  };
  for (std::size_t k = 25; k < truth.size(); ++k) {
    add_loop(k - 25, k, SE3::Identity());
  }
  const std::vector<SE3> expected = graph.optimise(start, true);
  EXPECT_EQ(graph.num_contradicted(), 0U);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset_m(1.0, 5.0);
  std::uniform_int_distribution<std::size_t> old(0, 40);
  for (std::size_t i = 0; i < 22; ++i) {
    SE3 error = SE3::Identity();
    error.translation() = Eigen::Vector3d(offset_m(random), -offset_m(random), 0.0);
    add_loop(old(random), 45 + i, error);
  }
  const std::vector<SE3> moved = graph.optimise(start, true);
  EXPECT_EQ(graph.num_contradicted(), 22U);
  double worst_m = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    worst_m = std::max(worst_m, (moved[k].translation() - expected[k].translation()).norm());
  }
  EXPECT_LT(worst_m, 0.05);
}

// Three rounds with exact steps and loops, of which one is an outlier. Without the keyframes of the
// second round the graph still finds all others where they were, and is of none more certain.
TEST(KeyframeGraph, WithoutSomeKeyframesTheOthersStay) {
  std::vector<SE3> truth = rounds();
  KeyframeGraph graph(kGround);
  const auto edge = [&](std::size_t from, std::size_t to) -> registration::PoseEdge3d {
    return {.from = from, .to = to, .T_from_to = truth[from].inverse() * truth[to]};
  };
  for (std::size_t k = 0; k < truth.size(); ++k) {
    graph.add_keyframe(true);
    if (k > 0) {
      registration::PoseEdge3d step = edge(k - 1, k);
      step.information = information(0.01, 0.002);
      graph.add_step(step);
    }
    if (k >= 25) {
      registration::PoseEdge3d loop = edge(k - 25, k);
      loop.information = information(0.005, 0.001);
      loop.information(0, 0) = 0.0;  // a degenerate direction
      loop.may_be_wrong = true;
      loop.T_from_to.translation().y() += k == 40 ? 2.0 : 0.0;
      graph.add_loop(loop);
    }
  }
  (void)graph.optimise(truth, false);
  EXPECT_EQ(graph.num_contradicted(), 1U);
  std::vector<Matrix6d> before = graph.uncertainties(truth, truth.size() - 1);
  for (int i = 0; i < 25; ++i) {
    graph.drop_keyframe(25);
    truth.erase(truth.begin() + 25);
    before.erase(before.begin() + 25);
  }
  ASSERT_EQ(graph.steps().size(), truth.size() - 1);
  EXPECT_LE(graph.num_loops(), truth.size());
  std::vector<SE3> start = truth;
  for (std::size_t k = 1; k < start.size(); ++k) {
    start[k].translation().x() += k % 2 == 0 ? 0.02 : -0.02;
  }
  const std::vector<SE3> found = graph.optimise(start, false);
  EXPECT_EQ(graph.num_contradicted(), 0U);
  const std::vector<Matrix6d> after = graph.uncertainties(truth, truth.size() - 1);
  // The search for the most certain path compares covariances by one number, so it may find one
  // that is a few per cent better.
  const auto variance_m2 = [](const Matrix6d& covariance) {
    return covariance(0, 0) + covariance(1, 1);
  };
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_LT((found[k].translation() - truth[k].translation()).norm(), 1e-4) << k;
    EXPECT_GE(variance_m2(after[k]), 0.9 * variance_m2(before[k])) << k;
  }
}

// Keyframes in a row, of which the middle one has drifted; a loop past it is surer than the steps
// and corrects that. It is the only one, so the chain must stay joined to where it leads.
TEST(KeyframeGraph, TheOnlyLoopOfADroppedKeyframeIsNotLost) {
  std::vector<SE3> truth(6, SE3::Identity());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    truth[k].translation().x() = static_cast<double>(k);
  }
  KeyframeGraph graph(kGround);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    graph.add_keyframe(false);
    if (k > 0) {
      SE3 step = truth[k - 1].inverse() * truth[k];
      step.translation().y() += k == 4 ? 0.5 : 0.0;
      graph.add_step({.from = k - 1,
                      .to = k,
                      .T_from_to = step,
                      .information = k == 4 ? information(1.0, 0.1) : information(0.01, 0.002)});
    }
  }
  graph.add_loop({.from = 2,
                  .to = 5,
                  .T_from_to = truth[2].inverse() * truth[5],
                  .information = information(0.005, 0.001),
                  .may_be_wrong = true});
  std::vector<SE3> corrected = graph.optimise(truth, true);
  EXPECT_LT((corrected[5].translation() - truth[5].translation()).norm(), 0.01);
  graph.drop_keyframe(2);
  corrected.erase(corrected.begin() + 2);
  EXPECT_EQ(graph.num_loops(), 1U);
  const std::vector<SE3> moved = graph.optimise(corrected, true);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    EXPECT_LT((moved[k].translation() - corrected[k].translation()).norm(), 0.01) << k;
  }
}

// The robot was tracked against the place of its first round: this is known before the graph is
// optimised.
TEST(KeyframeGraph, ALoopWithAWeightCountsAtOnce) {
  const std::vector<SE3> poses = rounds();
  KeyframeGraph graph(kGround);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    graph.add_keyframe(false);
    if (k > 0) {
      graph.add_step({.from = k - 1,
                      .to = k,
                      .T_from_to = poses[k - 1].inverse() * poses[k],
                      .information = information(0.01, 0.002)});
    }
  }
  const std::size_t last = poses.size() - 1;
  const registration::PoseEdge3d loop{.from = 0,
                                      .to = last,
                                      .T_from_to = poses[0].inverse() * poses[last],
                                      .information = information(0.01, 0.002),
                                      .may_be_wrong = true};
  const Matrix6d without = graph.uncertainties(poses, last)[0];
  graph.add_loop(loop);
  EXPECT_EQ(graph.uncertainties(poses, last)[0], without);
  graph.add_loop(loop, 1.0);
  // Seen from the last keyframe, the orientation of the loop moves the first one, too.
  const double arm_m = poses[0].translation().y() - poses[last].translation().y();
  EXPECT_NEAR(graph.uncertainties(poses, last)[0](0, 0), 1e-4 + 4e-6 * arm_m * arm_m, 1e-9);
  EXPECT_GT(without(0, 0), 70e-4);
}

}  // namespace keyframe_graph_test
}  // namespace nodmap::slam6d
