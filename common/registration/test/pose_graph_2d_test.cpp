// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "common/registration/pose_graph.hpp"

namespace nodmap::registration {
namespace {

using geometry::SE2;

double distance(const SE2& a, const SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

Eigen::Matrix3d information(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m),
                         1.0 / (sigma_rad * sigma_rad))
      .asDiagonal();
}

/// Twice round a square of 10 m x 10 m: nodes 1 m apart, noisy odometry, and a true loop from each
/// node of the second round to that of the first.
struct Drive {
  static constexpr std::size_t kRound = 40;
  std::vector<SE2> truth;
  PoseGraph2d graph;

  explicit Drive(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> unit;
    const auto measured = [&](const SE2& from, const SE2& to, double sigma_m, double sigma_rad) {
      const SE2 T = from.inverse() * to;
      return SE2{T.x + sigma_m * unit(random), T.y + sigma_m * unit(random),
                 T.yaw + sigma_rad * unit(random)};
    };
    SE2 pose;
    for (std::size_t k = 0; k < 2 * kRound; ++k) {
      truth.push_back(pose);
      pose = pose * SE2{1.0, 0.0, k % 10 == 9 ? 0.5 * geometry::kPi : 0.0};
    }
    graph.add_node(truth[0]);
    for (std::size_t k = 1; k < truth.size(); ++k) {
      const SE2 T = measured(truth[k - 1], truth[k], 0.02, 0.01);
      graph.add_node(graph.nodes()[k - 1] * T);
      graph.add_edge({k - 1, k, T, information(0.02, 0.01)});
    }
    for (std::size_t k = 0; k < kRound; ++k) {
      const SE2 T = measured(truth[k], truth[k + kRound], 0.01, 0.005);
      graph.add_edge({k, k + kRound, T, information(0.01, 0.005), true});
    }
  }

  [[nodiscard]] double worst_m() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      worst = std::max(worst, distance(graph.nodes()[k], truth[k]));
    }
    return worst;
  }
};

/// The same cost without structure: numeric Jacobian, dense equations.
Eigen::VectorXd dense_gauss_newton(const PoseGraph2d& graph) {
  std::vector<SE2> nodes(graph.nodes().begin(), graph.nodes().end());
  const auto unknowns = static_cast<Eigen::Index>(3 * (nodes.size() - 1));
  const auto moved = [](SE2 pose, Eigen::Index axis, double d) {
    (axis == 0 ? pose.x : axis == 1 ? pose.y : pose.yaw) += d;
    return pose;
  };
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns);
    for (const PoseEdge2d& edge : graph.edges()) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, unknowns);
      constexpr double kStep = 1e-6;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
          const double scale = sign / (2.0 * kStep);
          if (edge.from > 0) {
            J.col(3 * (static_cast<Eigen::Index>(edge.from) - 1) + axis) +=
                scale * residual(edge, moved(nodes[edge.from], axis, sign * kStep), nodes[edge.to]);
          }
          J.col(3 * (static_cast<Eigen::Index>(edge.to) - 1) + axis) +=
              scale * residual(edge, nodes[edge.from], moved(nodes[edge.to], axis, sign * kStep));
        }
      }
      H += J.transpose() * edge.information * J;
      b += J.transpose() * edge.information * residual(edge, nodes[edge.from], nodes[edge.to]);
    }
    const Eigen::VectorXd step = H.ldlt().solve(-b);
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        nodes[k] = moved(nodes[k], axis, step[3 * (static_cast<Eigen::Index>(k) - 1) + axis]);
      }
    }
  }
  Eigen::VectorXd result(unknowns);
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    result.segment<3>(3 * (static_cast<Eigen::Index>(k) - 1)) << nodes[k].x, nodes[k].y,
        nodes[k].yaw;
  }
  return result;
}

// On a line all is linear: two measurements of one pose meet at their weighted mean.
TEST(PoseGraph2d, TwoEdgesMeetAtTheirWeightedMean) {
  PoseGraph2d graph;
  graph.add_node({});
  graph.add_node({5.0, 0.0, 0.0});
  graph.add_edge({0, 1, {1.0, 0.0, 0.0}, information(0.1, 0.1)});
  graph.add_edge({0, 1, {2.0, 0.0, 0.0}, information(0.2, 0.1)});
  EXPECT_TRUE(graph.optimise(false).converged);
  EXPECT_NEAR(graph.nodes()[1].x, (1.0 / 0.01 + 2.0 / 0.04) / (1.0 / 0.01 + 1.0 / 0.04), 1e-6);
  EXPECT_EQ(graph.nodes()[0].x, 0.0);
}

// The information is that of the frame of `from`: sure along x there, open across.
TEST(PoseGraph2d, InformationTurnsWithTheFirstNode) {
  PoseGraph2d graph;
  graph.add_node({0.0, 0.0, 0.5 * geometry::kPi});
  graph.add_node({0.0, 0.0, 0.5 * geometry::kPi});
  graph.add_edge({0, 1, {1.0, 0.0, 0.0}, Eigen::Vector3d(1e4, 0.0, 1e4).asDiagonal()});
  graph.add_edge({0, 1, {3.0, 3.0, 0.0}, information(1.0, 1.0)});
  graph.optimise(false);
  EXPECT_NEAR(graph.nodes()[1].y, 1.0, 1e-3);   // x of the first node
  EXPECT_NEAR(graph.nodes()[1].x, -3.0, 1e-3);  // its y
}

TEST(PoseGraph2d, EqualsDenseGaussNewton) {
  Drive drive(1);
  PoseGraph2d plain;
  for (const SE2& node : drive.graph.nodes()) {
    plain.add_node(node);
  }
  for (PoseEdge2d edge : drive.graph.edges()) {
    edge.may_be_wrong = false;
    plain.add_edge(edge);
  }
  const Eigen::VectorXd expected = dense_gauss_newton(plain);
  EXPECT_TRUE(plain.optimise(false).converged);
  for (std::size_t k = 1; k < plain.nodes().size(); ++k) {
    const auto pose = expected.segment<3>(3 * (static_cast<Eigen::Index>(k) - 1));
    // The step at which both stop.
    EXPECT_NEAR(plain.nodes()[k].x, pose.x(), 1e-5);
    EXPECT_NEAR(plain.nodes()[k].y, pose.y(), 1e-5);
    EXPECT_NEAR(geometry::angle_difference(plain.nodes()[k].yaw, pose.z()), 0.0, 1e-5);
  }
}

TEST(PoseGraph2d, LoopsTakeTheDriftOut) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Drive drive(seed);
    const double before_m = drive.worst_m();
    // Reweighting converges linearly: it takes more steps than a map needs.
    EXPECT_TRUE(drive.graph.optimise(true, 300).converged);
    EXPECT_LT(drive.worst_m(), before_m);
  }
}

// As many wrong loops as 30 % of all, from anywhere to anywhere.
TEST(PoseGraph2d, WrongLoopsMoveNothing) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Drive clean(seed);
    clean.graph.optimise(true);
    Drive spoilt(seed);
    std::mt19937 random(100 + seed);
    std::uniform_int_distribution<std::size_t> node(0, 2 * Drive::kRound - 1);
    std::uniform_real_distribution<double> metres(-5.0, 5.0);
    for (std::size_t added = 0; added < Drive::kRound * 3 / 7;) {
      const std::size_t from = node(random);
      const std::size_t to = node(random);
      if (from != to) {
        spoilt.graph.add_edge({from,
                               to,
                               {metres(random), metres(random), 0.3 * metres(random)},
                               information(0.01, 0.005),
                               true});
        ++added;
      }
    }
    spoilt.graph.optimise(true);
    for (std::size_t k = 0; k < clean.truth.size(); ++k) {
      EXPECT_LT(distance(spoilt.graph.nodes()[k], clean.graph.nodes()[k]), 0.05) << seed;
    }
  }
}

// A good loop that closes 3 m of drift looks worse than a wrong one at the first step.
TEST(PoseGraph2d, AGoodLoopIsKeptThoughItClosesALargeDrift) {
  PoseGraph2d graph;
  graph.add_node({});
  const double drift_rad = 0.01;
  for (std::size_t k = 1; k <= 60; ++k) {
    const SE2 step{0.5, 0.0, geometry::kPi / 30.0 + drift_rad};
    graph.add_node(graph.nodes()[k - 1] * step);
    graph.add_edge({k - 1, k, step, information(0.01, 0.01)});
  }
  EXPECT_GT(distance(graph.nodes()[60], graph.nodes()[0]), 2.0);
  graph.add_edge({0, 60, {}, information(0.01, 0.005), true});
  graph.optimise(true);
  EXPECT_GT(graph.weight(graph.edges().back()), 0.5);
  EXPECT_LT(distance(graph.nodes()[60], graph.nodes()[0]), 0.05);
}

TEST(PoseGraph2d, ANodeThatHangsOnNothingStays) {
  PoseGraph2d graph;
  graph.add_node({});
  graph.add_node({1.0, 2.0, 3.0});
  EXPECT_TRUE(graph.optimise(true).converged);
  EXPECT_EQ(graph.nodes()[1].x, 1.0);
  EXPECT_TRUE(PoseGraph2d().optimise(true).converged);
}

TEST(PoseGraph2d, BadEdgesAreRefused) {
  PoseGraph2d graph;
  graph.add_node({});
  graph.add_node({});
  EXPECT_THROW(graph.add_edge({0, 0, {}, information(1, 1)}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({0, 2, {}, information(1, 1)}), std::invalid_argument);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(graph.add_edge({0, 1, {kNan, 0.0, 0.0}, information(1, 1)}), std::invalid_argument);
  EXPECT_TRUE(graph.edges().empty());
}

}  // namespace
}  // namespace nodmap::registration
