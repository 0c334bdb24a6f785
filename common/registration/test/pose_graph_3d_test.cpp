// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "common/registration/pose_graph.hpp"

namespace nodmap::registration {
namespace {

using geometry::SE3;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

double distance(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).norm();
}

SE3 pose(const Eigen::Vector3d& translation_m, const Eigen::Vector3d& rotation_rad) {
  SE3 T = SE3::Identity();
  T.translation() = translation_m;
  T.linear() = geometry::rotation_of(rotation_rad);
  return T;
}

Matrix6d information(double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

SE3 moved(const SE3& T, const Vector6d& motion) {
  SE3 result = T;
  result.translation() += motion.head<3>();
  result.linear() = geometry::rotation_of(motion.tail<3>()) * T.linear();
  return result;
}

/// Twice round a square of 10 m x 10 m that climbs 10 cm a metre on one side and falls on the
/// opposite one: nodes 1 m apart, noisy odometry, and a true loop from each node of the second
/// round to that of the first.
struct Drive {
  static constexpr std::size_t kRound = 40;
  std::vector<SE3> truth;
  PoseGraph3d graph;

  explicit Drive(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> unit;
    const auto measured = [&](const SE3& from, const SE3& to, double sigma_m, double sigma_rad) {
      Vector6d error;
      for (Eigen::Index i = 0; i < 6; ++i) {
        error[i] = (i < 3 ? sigma_m : sigma_rad) * unit(random);
      }
      return moved(from.inverse() * to, error);
    };
    for (std::size_t k = 0; k < 2 * kRound; ++k) {
      const std::size_t side = k % kRound / 10;
      const auto along = static_cast<double>(k % 10);
      const double height_m = side == 0   ? 0.1 * along
                              : side == 1 ? 1.0
                              : side == 2 ? 1.0 - 0.1 * along
                                          : 0.0;
      const Eigen::Vector3d corners[] = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
      const Eigen::Matrix3d heading =
          geometry::rotation_of({0.0, 0.0, 0.5 * geometry::kPi * static_cast<double>(side)});
      SE3 T = SE3::Identity();
      T.translation() =
          corners[side] + heading.col(0) * along + height_m * Eigen::Vector3d::UnitZ();
      T.linear() = heading;
      truth.push_back(T);
    }
    graph.add_node(truth[0]);
    for (std::size_t k = 1; k < truth.size(); ++k) {
      const SE3 T = measured(truth[k - 1], truth[k], 0.02, 0.01);
      graph.add_node(graph.nodes()[k - 1] * T);
      graph.add_edge({k - 1, k, T, information(0.02, 0.01)});
    }
    for (std::size_t k = 0; k < kRound; ++k) {
      const SE3 T = measured(truth[k], truth[k + kRound], 0.01, 0.005);
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
std::vector<SE3> dense_gauss_newton(const PoseGraph3d& graph) {
  std::vector<SE3> nodes(graph.nodes().begin(), graph.nodes().end());
  const auto unknowns = static_cast<Eigen::Index>(6 * (nodes.size() - 1));
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns);
    for (const PoseEdge3d& edge : graph.edges()) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, unknowns);
      constexpr double kStep = 1e-6;
      for (Eigen::Index axis = 0; axis < 6; ++axis) {
        for (const double sign : {1.0, -1.0}) {
          const double scale = sign / (2.0 * kStep);
          const Vector6d motion = sign * kStep * Vector6d::Unit(axis);
          if (edge.from > 0) {
            J.col(6 * (static_cast<Eigen::Index>(edge.from) - 1) + axis) +=
                scale * residual(edge, moved(nodes[edge.from], motion), nodes[edge.to]);
          }
          J.col(6 * (static_cast<Eigen::Index>(edge.to) - 1) + axis) +=
              scale * residual(edge, nodes[edge.from], moved(nodes[edge.to], motion));
        }
      }
      H += J.transpose() * edge.information * J;
      b += J.transpose() * edge.information * residual(edge, nodes[edge.from], nodes[edge.to]);
    }
    const Eigen::VectorXd step = H.ldlt().solve(-b);
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      nodes[k] = moved(nodes[k], step.segment<6>(6 * (static_cast<Eigen::Index>(k) - 1)));
    }
  }
  return nodes;
}

// Closed form: where rotations are known, a drift of equal steps is taken back evenly.
TEST(PoseGraph3d, ASquareLoopTakesItsDriftBackEvenly) {
  const Eigen::Vector3d drift_m(0.01, -0.004, 0.006);  // of each step, in map
  constexpr std::size_t kSteps = 40;
  const auto corner = [](std::size_t k) -> Eigen::Vector3d {
    const auto along = static_cast<double>(k % 10);
    const Eigen::Vector3d sides[] = {
        {along, 0, 0}, {10, along, 0}, {10 - along, 10, 0}, {0, 10 - along, 0}};
    return sides[k / 10 % 4];
  };
  PoseGraph3d graph;
  graph.add_node(SE3::Identity());
  for (std::size_t k = 1; k <= kSteps; ++k) {
    const Eigen::Vector3d step_m = corner(k) - corner(k - 1) + drift_m;
    const SE3 T = pose(step_m, Eigen::Vector3d::Zero());
    graph.add_node(graph.nodes()[k - 1] * T);
    graph.add_edge({k - 1, k, T, information(0.02, 1e-6)});
  }
  graph.add_edge({0, kSteps, SE3::Identity(), information(1e-5, 1e-6), true});
  EXPECT_TRUE(graph.optimise(true, 200).converged);
  for (std::size_t k = 0; k <= kSteps; ++k) {
    // The rotations give way by a millionth of a radian, at up to 10 m.
    EXPECT_LT((graph.nodes()[k].translation() - corner(k)).norm(), 1e-4) << k;
  }
}

TEST(PoseGraph3d, EqualsDenseGaussNewton) {
  Drive drive(1);
  PoseGraph3d plain;
  for (const SE3& node : drive.graph.nodes()) {
    plain.add_node(node);
  }
  for (PoseEdge3d edge : drive.graph.edges()) {
    edge.may_be_wrong = false;
    plain.add_edge(edge);
  }
  const std::vector<SE3> expected = dense_gauss_newton(plain);
  EXPECT_TRUE(plain.optimise(false).converged);
  for (std::size_t k = 1; k < plain.nodes().size(); ++k) {
    // The step at which both stop.
    EXPECT_LT(distance(plain.nodes()[k], expected[k]), 1e-4) << k;
    EXPECT_LT(geometry::rotation_angle(plain.nodes()[k].inverse() * expected[k]), 1e-5) << k;
  }
}

TEST(PoseGraph3d, LoopsTakeTheDriftOut) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Drive drive(seed);
    const double before_m = drive.worst_m();
    EXPECT_TRUE(drive.graph.optimise(true, 300).converged);
    EXPECT_LT(drive.worst_m(), before_m) << seed;
  }
}

// As many wrong loops as 30 % of all, from anywhere to anywhere.
TEST(PoseGraph3d, WrongLoopsMoveNothing) {
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
        const SE3 T = pose({metres(random), metres(random), 0.2 * metres(random)},
                           {0.0, 0.0, 0.3 * metres(random)});
        spoilt.graph.add_edge({from, to, T, information(0.01, 0.005), true});
        ++added;
      }
    }
    spoilt.graph.optimise(true);
    for (std::size_t k = 0; k < clean.truth.size(); ++k) {
      EXPECT_LT(distance(spoilt.graph.nodes()[k], clean.graph.nodes()[k]), 0.05) << seed;
    }
  }
}

TEST(PoseGraph3d, BadEdgesAreRefused) {
  PoseGraph3d graph;
  graph.add_node(SE3::Identity());
  graph.add_node(SE3::Identity());
  SE3 bad = SE3::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(graph.add_edge({.from = 0, .to = 0}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({.from = 0, .to = 2}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({.from = 0, .to = 1, .T_from_to = bad}), std::invalid_argument);
  EXPECT_TRUE(graph.edges().empty());
}

}  // namespace
}  // namespace nodmap::registration
