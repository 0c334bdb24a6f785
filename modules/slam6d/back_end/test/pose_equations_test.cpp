// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/pose_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace nodmap::slam6d {
namespace pose_equations_test {

constexpr std::size_t kPoses = 30;

Matrix6d random_matrix(std::mt19937& engine) {
  std::normal_distribution<double> normal;
  return Matrix6d::NullaryExpr([&] { return normal(engine); });
}

// Each pose is joined to the one before, and every third to one long before, as by loops. The same
// equations, dense, are the oracle.
struct RandomGraph {
  PoseEquations equations{kPoses};
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6 * kPoses, 6 * kPoses);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(6 * kPoses);

  explicit RandomGraph(unsigned seed) {
    std::mt19937 engine(seed);
    for (std::size_t i = 0; i < kPoses; ++i) {
      const Vector6d gradient = random_matrix(engine).col(0);
      equations.gradient(i) += gradient;
      g.segment<6>(static_cast<Eigen::Index>(6 * i)) = gradient;
      add(i, i, 1e-3 * Matrix6d::Identity());
      if (i > 0) {
        join(i - 1, i, engine);
      }
      if (i > 9 && i % 3 == 0) {
        join(engine() % (i - 8), i, engine);
      }
    }
  }

 private:
  void add(std::size_t row, std::size_t column, const Matrix6d& block) {
    equations.block(row, column) += block;
    const auto r = static_cast<Eigen::Index>(6 * row);
    const auto c = static_cast<Eigen::Index>(6 * column);
    H.block<6, 6>(r, c) += block;
    if (row != column) {
      H.block<6, 6>(c, r) += block.transpose();
    }
  }
  void join(std::size_t from, std::size_t to, std::mt19937& engine) {
    const Matrix6d A = random_matrix(engine);
    const Matrix6d B = random_matrix(engine);
    add(from, from, A.transpose() * A);
    add(from, to, A.transpose() * B);
    add(to, to, B.transpose() * B);
  }
};

TEST(PoseEquations, AreSolvedAsDenseOnes) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const RandomGraph graph(seed);
    const auto motions = graph.equations.solve();
    ASSERT_TRUE(motions);
    const Eigen::Index free = 6 * (kPoses - 1);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(6 * kPoses);
    expected.tail(free) = graph.H.bottomRightCorner(free, free).ldlt().solve(graph.g.tail(free));
    // Both round; the condition of these matrices is about 1e6.
    EXPECT_LT((*motions - expected).norm(), 1e-8 * expected.norm()) << "seed " << seed;
  }
}

TEST(PoseEquations, TheFirstPoseAloneDoesNotMove) {
  PoseEquations equations(1);
  equations.block(0, 0) = Matrix6d::Identity();
  equations.gradient(0) = Vector6d::Ones();
  const auto motions = equations.solve();
  ASSERT_TRUE(motions);
  EXPECT_EQ(*motions, Eigen::VectorXd::Zero(6));
}

TEST(PoseEquations, APoseThatNothingDeterminesHasNoSolution) {
  PoseEquations equations(3);
  equations.block(1, 1) = Matrix6d::Identity();
  EXPECT_FALSE(equations.solve());
}

}  // namespace pose_equations_test
}  // namespace nodmap::slam6d
