// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/pose_graph.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "common/registration/test/moved.hpp"

namespace nodmap::registration {
namespace pose_graph_test {

using geometry::distance_m;
using geometry::rotation_rad;
using geometry::SE2;
using geometry::SE3;
using test::moved;

// Number of steps of one metre on a side of the square, and around the whole square.
constexpr std::size_t kSideSteps = 10;
constexpr std::size_t kRound = 4 * kSideSteps;

// Sets T to the pose of node `k` on a drive around a square of 10 m x 10 m in steps of one metre.
void on_square(std::size_t k, SE2& T) {
  const Eigen::Vector2d corners[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const std::size_t side = k % kRound / kSideSteps;
  const double yaw = 0.5 * geometry::kPi * static_cast<double>(side);
  const auto along = static_cast<double>(k % kSideSteps);
  T = {corners[side].x() + along * std::cos(yaw), corners[side].y() + along * std::sin(yaw), yaw};
}
// The same in space: the ground rises by 10 cm per metre on the first side and falls again on the
// third.
void on_square(std::size_t k, SE3& T) {
  SE2 flat;
  on_square(k, flat);
  const std::size_t side = k % kRound / kSideSteps;
  const auto along = static_cast<double>(k % kSideSteps);
  T = geometry::to_se3(flat);
  T.translation().z() = side == 0   ? 0.1 * along
                        : side == 1 ? 1.0
                        : side == 2 ? 1.0 - 0.1 * along
                                    : 0.0;
}

// The standard deviations of a pose: `sigma_m` for each translation, `sigma_rad` for each
// rotation.
template <class Pose>
PoseVector<Pose> sigmas(double sigma_m, double sigma_rad) {
  constexpr int kTranslations = PoseSpace<Pose>::kDimensions == 3 ? 2 : 3;
  PoseVector<Pose> sigma = PoseVector<Pose>::Constant(sigma_rad);
  sigma.template head<kTranslations>().setConstant(sigma_m);
  return sigma;
}

template <class Pose>
PoseMatrix<Pose> information(double sigma_m, double sigma_rad) {
  return sigmas<Pose>(sigma_m, sigma_rad).cwiseAbs2().cwiseInverse().asDiagonal();
}

// A drive twice around the square, with noisy odometry and a correct loop closure from each node
// of the first round to the same place in the second.
template <class Pose>
struct Drive {
  std::vector<Pose> truth;
  PoseGraph<Pose> graph;

  explicit Drive(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> unit;
    const auto measured = [&](const Pose& from, const Pose& to, double sigma_m, double sigma_rad) {
      PoseVector<Pose> error = sigmas<Pose>(sigma_m, sigma_rad);
      for (double& value : error) {
        value *= unit(random);
      }
      return moved(from.inverse() * to, error);
    };
    for (std::size_t k = 0; k < 2 * kRound; ++k) {
      on_square(k, truth.emplace_back(PoseSpace<Pose>::identity()));
    }
    graph.add_node(truth[0]);
    for (std::size_t k = 1; k < truth.size(); ++k) {
      const Pose T = measured(truth[k - 1], truth[k], 0.02, 0.01);
      graph.add_node(graph.nodes()[k - 1] * T);
      graph.add_edge({k - 1, k, T, information<Pose>(0.02, 0.01)});
    }
    for (std::size_t k = 0; k < kRound; ++k) {
      const Pose T = measured(truth[k], truth[k + kRound], 0.01, 0.005);
      graph.add_edge({k, k + kRound, T, information<Pose>(0.01, 0.005), true});
    }
  }

  [[nodiscard]] double worst_m() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      worst = std::max(worst, distance_m(graph.nodes()[k], truth[k]));
    }
    return worst;
  }
};

// The oracle: minimises the same cost with a numeric Jacobian and dense equations.
template <class Pose>
std::vector<Pose> dense_gauss_newton(const PoseGraph<Pose>& graph) {
  constexpr Eigen::Index kSize = PoseSpace<Pose>::kDimensions;
  const auto first_unknown = [](std::size_t node) {
    return kSize * (static_cast<Eigen::Index>(node) - 1);
  };
  std::vector<Pose> nodes(graph.nodes().begin(), graph.nodes().end());
  const Eigen::Index unknowns = first_unknown(nodes.size());
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns);
    for (const PoseEdge<Pose>& edge : graph.edges()) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(kSize, unknowns);
      constexpr double kStep = 1e-6;
      for (Eigen::Index axis = 0; axis < kSize; ++axis) {
        for (const double sign : {1.0, -1.0}) {
          const double scale = sign / (2.0 * kStep);
          const PoseVector<Pose> motion = sign * kStep * PoseVector<Pose>::Unit(axis);
          if (edge.from > 0) {
            J.col(first_unknown(edge.from) + axis) +=
                scale * residual(edge, moved(nodes[edge.from], motion), nodes[edge.to]);
          }
          J.col(first_unknown(edge.to) + axis) +=
              scale * residual(edge, nodes[edge.from], moved(nodes[edge.to], motion));
        }
      }
      H += J.transpose() * edge.information * J;
      b += J.transpose() * edge.information * residual(edge, nodes[edge.from], nodes[edge.to]);
    }
    const Eigen::VectorXd step = H.ldlt().solve(-b);
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      nodes[k] = moved(nodes[k], step.segment<kSize>(first_unknown(k)));
    }
  }
  return nodes;
}

template <class Pose>
class PoseGraphTest : public testing::Test {};
using Poses = testing::Types<SE2, SE3>;
TYPED_TEST_SUITE(PoseGraphTest, Poses);

TYPED_TEST(PoseGraphTest, EqualsDenseGaussNewton) {
  using Pose = TypeParam;
  Drive<Pose> drive(1);
  PoseGraph<Pose> plain;
  for (const Pose& node : drive.graph.nodes()) {
    plain.add_node(node);
  }
  for (PoseEdge<Pose> edge : drive.graph.edges()) {
    edge.may_be_wrong = false;
    plain.add_edge(edge);
  }
  const std::vector<Pose> expected = dense_gauss_newton(plain);
  EXPECT_TRUE(plain.optimise(false).converged);
  for (std::size_t k = 1; k < plain.nodes().size(); ++k) {
    // Both stop when their steps are below this.
    EXPECT_LT(distance_m(plain.nodes()[k], expected[k]), 1e-5) << k;
    EXPECT_LT(rotation_rad(plain.nodes()[k], expected[k]), 1e-5) << k;
  }
}

TYPED_TEST(PoseGraphTest, CorrectLoopClosuresReduceTheDrift) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Drive<TypeParam> drive(seed);
    const double before_m = drive.worst_m();
    // Reweighting converges linearly, so full convergence needs more iterations than optimise()
    // uses by default.
    EXPECT_TRUE(drive.graph.optimise(true, 300).converged);
    EXPECT_LT(drive.worst_m(), before_m) << seed;
  }
}

// 30 % of all loop closures are wrong and join random nodes.
TYPED_TEST(PoseGraphTest, WrongLoopClosuresHardlyMoveThePoses) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Drive<TypeParam> clean(seed);
    clean.graph.optimise(true);
    Drive<TypeParam> spoilt(seed);
    std::mt19937 random(100 + seed);
    std::uniform_int_distribution<std::size_t> node(0, 2 * kRound - 1);
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    for (std::size_t added = 0; added < kRound * 3 / 7;) {
      const std::size_t from = node(random);
      const std::size_t to = node(random);
      if (from == to) {
        continue;
      }
      PoseVector<TypeParam> wrong = sigmas<TypeParam>(5.0, 1.5);
      for (double& value : wrong) {
        value *= share(random);
      }
      spoilt.graph.add_edge({from, to, moved(PoseSpace<TypeParam>::identity(), wrong),
                             information<TypeParam>(0.01, 0.005), true});
      ++added;
    }
    spoilt.graph.optimise(true);
    for (std::size_t k = 0; k < clean.truth.size(); ++k) {
      EXPECT_LT(distance_m(spoilt.graph.nodes()[k], clean.graph.nodes()[k]), 0.05) << seed;
    }
  }
}

TYPED_TEST(PoseGraphTest, InvalidEdgesAreRefused) {
  using Pose = TypeParam;
  const Pose identity = PoseSpace<Pose>::identity();
  PoseGraph<Pose> graph;
  graph.add_node(identity);
  graph.add_node(identity);
  EXPECT_THROW(graph.add_edge({.from = 0, .to = 0}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({.from = 0, .to = 2}), std::invalid_argument);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Pose bad = moved(identity, kNan * PoseVector<Pose>::Unit(0));
  EXPECT_THROW(graph.add_edge({.from = 0, .to = 1, .T_from_to = bad}), std::invalid_argument);
  EXPECT_TRUE(graph.edges().empty());
}

TYPED_TEST(PoseGraphTest, EquationsThatOverflowDoNotConvergeAndLeaveThePoses) {
  using Pose = TypeParam;
  Pose T_map_node = PoseSpace<Pose>::identity();
  on_square(17, T_map_node);
  PoseGraph<Pose> graph;
  graph.add_node(PoseSpace<Pose>::identity());
  graph.add_node(T_map_node);
  for (int i = 0; i < 2; ++i) {
    graph.add_edge(
        {.from = 0,
         .to = 1,
         .information = std::numeric_limits<double>::max() * PoseMatrix<Pose>::Identity()});
  }
  EXPECT_FALSE(graph.optimise(false).converged);
  EXPECT_EQ(distance_m(graph.nodes()[1], T_map_node), 0.0);
}

TYPED_TEST(PoseGraphTest, ANodeWithoutEdgesKeepsItsPose) {
  using Pose = TypeParam;
  Pose loose = PoseSpace<Pose>::identity();
  on_square(17, loose);
  PoseGraph<Pose> graph;
  graph.add_node(PoseSpace<Pose>::identity());
  graph.add_node(loose);
  EXPECT_TRUE(graph.optimise(true).converged);
  EXPECT_EQ(distance_m(graph.nodes()[1], loose), 0.0);
  EXPECT_TRUE(PoseGraph<Pose>().optimise(true).converged);
}

// Without rotations the problem is linear: the closed form is the weighted mean of the two
// measurements.
TEST(PoseGraph, TwoEdgesToOneNodeGiveTheirWeightedMean) {
  PoseGraph2d graph;
  graph.add_node({});
  graph.add_node({5.0, 0.0, 0.0});
  graph.add_edge({0, 1, {1.0, 0.0, 0.0}, information<SE2>(0.1, 0.1)});
  graph.add_edge({0, 1, {2.0, 0.0, 0.0}, information<SE2>(0.2, 0.1)});
  EXPECT_TRUE(graph.optimise(false).converged);
  EXPECT_NEAR(graph.nodes()[1].x, (1.0 / 0.01 + 2.0 / 0.04) / (1.0 / 0.01 + 1.0 / 0.04), 1e-6);
  EXPECT_EQ(graph.nodes()[0].x, 0.0);
}

// The information is in the frame of `from`: precise along its x axis, imprecise across it.
TEST(PoseGraph, InformationOfAnEdgeIsInTheFrameOfItsFirstNode) {
  PoseGraph2d graph;
  graph.add_node({0.0, 0.0, 0.5 * geometry::kPi});
  graph.add_node({0.0, 0.0, 0.5 * geometry::kPi});
  graph.add_edge({0, 1, {1.0, 0.0, 0.0}, Eigen::Vector3d(1e4, 0.0, 1e4).asDiagonal()});
  graph.add_edge({0, 1, {3.0, 3.0, 0.0}, information<SE2>(1.0, 1.0)});
  graph.optimise(false);
  EXPECT_NEAR(graph.nodes()[1].y, 1.0, 1e-3);   // x of the first node
  EXPECT_NEAR(graph.nodes()[1].x, -3.0, 1e-3);  // its y
}

// At the first step, a correct loop closure that closes 3 m of drift has a larger residual than a
// wrong one.
TEST(PoseGraph, ACorrectLoopClosureIsKeptDespiteALargeDrift) {
  PoseGraph2d graph;
  graph.add_node({});
  const double drift_rad = 0.01;
  for (std::size_t k = 1; k <= 60; ++k) {
    const SE2 step{0.5, 0.0, geometry::kPi / 30.0 + drift_rad};
    graph.add_node(graph.nodes()[k - 1] * step);
    graph.add_edge({k - 1, k, step, information<SE2>(0.01, 0.01)});
  }
  EXPECT_GT(distance_m(graph.nodes()[60], graph.nodes()[0]), 2.0);
  graph.add_edge({0, 60, {}, information<SE2>(0.01, 0.005), true});
  graph.optimise(true);
  EXPECT_GT(graph.weight(graph.edges().back()), 0.5);
  EXPECT_LT(distance_m(graph.nodes()[60], graph.nodes()[0]), 0.05);
}

// The closed form: if the rotations are known, a drift that is the same in each step is corrected
// by the same amount in each step.
TEST(PoseGraph, ALoopClosureDistributesTheDriftEvenly) {
  const Eigen::Vector3d drift_m(0.01, -0.004, 0.006);  // of each step, in map
  const auto place = [](std::size_t k) {
    SE2 T;
    on_square(k, T);
    return Eigen::Vector3d(T.x, T.y, 0.0);
  };
  PoseGraph3d graph;
  graph.add_node(SE3::Identity());
  for (std::size_t k = 1; k <= kRound; ++k) {
    SE3 T = SE3::Identity();
    T.translation() = place(k) - place(k - 1) + drift_m;
    graph.add_node(graph.nodes()[k - 1] * T);
    graph.add_edge({k - 1, k, T, information<SE3>(0.02, 1e-6)});
  }
  graph.add_edge({0, kRound, SE3::Identity(), information<SE3>(1e-5, 1e-6), true});
  EXPECT_TRUE(graph.optimise(true, 200).converged);
  for (std::size_t k = 0; k <= kRound; ++k) {
    // The rotations change by about a millionth of a radian, at distances of up to 10 m.
    EXPECT_LT((graph.nodes()[k].translation() - place(k)).norm(), 1e-4) << k;
  }
}

}  // namespace pose_graph_test
}  // namespace nodmap::registration
