// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap_graph.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <vector>

namespace nodmap::slam2d {
namespace submap_graph_test {

using geometry::SE2;
using registration::PoseEdge2d;

const SE2 kFirst{2.0, -1.0, 0.7};
const SE2 kSecond{-0.5, 3.0, -1.9};
// Central differences over 2e-6 m, of functions with a curvature of a few per metre.
constexpr double kDifferences = 1e-6;

Eigen::Matrix3d some_information(double scale) {
  Eigen::Matrix3d root;
  root << 10.0, 2.0, -3.0, 0.0, 20.0, 5.0, 0.0, 0.0, 30.0;
  return scale * root * root.transpose();
}

PoseEdge2d edge(std::size_t from, std::size_t to, const SE2& T_from_to, double scale = 1.0) {
  return {from, to, T_from_to, some_information(scale), false};
}

// The numeric derivative of the pose that `function` returns with respect to (x, y, yaw) of its
// argument.
Eigen::Matrix3d jacobian(const SE2& at, const std::function<SE2(const SE2&)>& function) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d J;
  for (int column = 0; column < 3; ++column) {
    const auto moved = [&](double step) {
      return function({at.x + (column == 0 ? step : 0.0), at.y + (column == 1 ? step : 0.0),
                       at.yaw + (column == 2 ? step : 0.0)});
    };
    const SE2 high = moved(kStep);
    const SE2 low = moved(-kStep);
    J.col(column) = Eigen::Vector3d(high.x - low.x, high.y - low.y,
                                    geometry::angle_difference(high.yaw, low.yaw)) /
                    (2.0 * kStep);
  }
  return J;
}

TEST(SubmapGraph, AReversedEdgeHasTheCovarianceOfTheInversePose) {
  const PoseEdge2d there = edge(3, 5, kFirst);
  const PoseEdge2d back = reversed(there);
  EXPECT_EQ(back.from, 5U);
  EXPECT_EQ(back.to, 3U);
  const Eigen::Matrix3d J = jacobian(kFirst, [](const SE2& pose) { return pose.inverse(); });
  const Eigen::Matrix3d expected = J * there.information.inverse() * J.transpose();
  EXPECT_TRUE(back.information.inverse().isApprox(expected, kDifferences));
}

TEST(SubmapGraph, AComposedEdgeHasTheSumOfBothCovariances) {
  const PoseEdge2d a_b = edge(0, 1, kFirst);
  const PoseEdge2d b_c = edge(1, 2, kSecond, 0.3);
  const PoseEdge2d a_c = composed(a_b, b_c);
  EXPECT_EQ(a_c.from, 0U);
  EXPECT_EQ(a_c.to, 2U);
  const Eigen::Matrix3d J_a = jacobian(kFirst, [](const SE2& pose) { return pose * kSecond; });
  const Eigen::Matrix3d J_b = jacobian(kSecond, [](const SE2& pose) { return kFirst * pose; });
  const Eigen::Matrix3d expected = J_a * a_b.information.inverse() * J_a.transpose() +
                                   J_b * b_c.information.inverse() * J_b.transpose();
  EXPECT_TRUE(a_c.information.inverse().isApprox(expected, kDifferences));
}

// Edges along corridors, in which the position along the corridor is unknown, are composed and
// reversed again and again. That direction stays unknown, and every result has a valid covariance.
TEST(SubmapGraph, AnUnknownDirectionStaysUnknown) {
  PoseEdge2d sum = edge(0, 1, kFirst);
  sum.information = Eigen::Vector3d(0.0, 4e4, 1e6).asDiagonal();
  const PoseEdge2d step = sum;
  for (int i = 0; i < 100; ++i) {
    sum = reversed(composed(sum, step));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum.information);
    // Rounding of eigenvalues up to 1e6.
    ASSERT_GT(solver.eigenvalues()[0], -1e-9);
    ASSERT_LT(solver.eigenvalues()[0], 1e-4);
    ASSERT_TRUE(covariance_of(sum.information).allFinite());
    ASSERT_GT(covariance_of(sum.information).diagonal().minCoeff(), 0.0);
  }
}

// The heading of an edge is uncertain, too. Seen from its other end that moves the far submap
// aside.
TEST(SubmapGraph, AnUncertaintyIsThatOfThePathToTheLocalSubmap) {
  const std::vector<SE2> poses{{1.0, 2.0, 0.3}, {4.0, 3.0, -0.5}, {3.0, 7.0, 2.0}};
  std::vector<Submap> submaps;
  for (const SE2& pose : poses) {
    submaps.emplace_back(0, pose, MapParams{});
  }
  const PoseEdge2d first = edge(0, 1, poses[0].inverse() * poses[1]);
  const PoseEdge2d second = edge(1, 2, poses[1].inverse() * poses[2], 0.3);
  SubmapGraph graph;
  graph.add_chain_edge(first);
  graph.add_chain_edge(second);
  const auto in_map = [](const PoseEdge2d& path, const SE2& T_map_from) {
    return rotated(path.information.inverse(), T_map_from.yaw);
  };
  // covariance_of() adds 1e-6 to an information of at least 80.
  constexpr double kRounding = 1e-6;
  const auto from_first = graph.uncertainties(submaps, 0);
  EXPECT_TRUE(from_first[1].isApprox(in_map(first, poses[0]), kRounding));
  EXPECT_TRUE(from_first[2].isApprox(in_map(composed(first, second), poses[0]), kRounding));
  const auto from_last = graph.uncertainties(submaps, 2);
  EXPECT_TRUE(from_last[1].isApprox(in_map(reversed(second), poses[2]), kRounding));
  EXPECT_TRUE(
      from_last[0].isApprox(in_map(reversed(composed(first, second)), poses[2]), kRounding));
}

// Five submaps in a row, with loops from 1 to 3 and 4.
struct Row {
  Row() {
    for (std::size_t s = 0; s < 5; ++s) {
      const auto steps = static_cast<double>(s);
      submaps.emplace_back(10 * s, SE2{2.0 * steps, 0.3 * steps * steps, 0.4 * steps}, MapParams{});
    }
    for (std::size_t s = 0; s < 4; ++s) {
      graph.add_chain_edge(edge(s, s + 1, between(s, s + 1)));
    }
    graph.add_loop(1, 3, between(1, 3), some_information(4.0));
    graph.add_loop(1, 4, between(1, 4), some_information(1.0));
  }
  [[nodiscard]] SE2 between(std::size_t from, std::size_t to) const {
    return submaps[from].T_map_submap.inverse() * submaps[to].T_map_submap;
  }
  std::vector<Submap> submaps;
  SubmapGraph graph;
};

TEST(SubmapGraph, LoopsOfADroppedSubmapMoveToTheOneWithTheMostCertainEdge) {
  Row row;
  row.graph.drop_submap(1, row.submaps);
  row.submaps.erase(row.submaps.begin() + 1);
  // The edge from 1 to 3 was the most certain one. Submap 3 now has the number 2, and the loop to
  // 4, now 3, begins there. The loop to 3 itself goes to 2, now 1, the next in the chain.
  const std::vector<PoseEdge2d> loops = row.graph.loops();
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].from, 1U);
  EXPECT_EQ(loops[0].to, 2U);
  EXPECT_EQ(loops[1].from, 2U);
  EXPECT_EQ(loops[1].to, 3U);
  for (const PoseEdge2d& loop : loops) {
    EXPECT_FALSE(SubmapGraph::is_outlier(loop, row.submaps));
  }
  // The loops are less certain than before, because they lead through the dropped submap and
  // covariances add up.
  EXPECT_LT(loops[0].information.trace(), some_information(4.0).trace());
  EXPECT_LT(loops[1].information.trace(), some_information(1.0).trace());
  // Poses that agreed with all edges still agree, so nothing moves.
  std::vector<Submap> moved = row.submaps;
  row.graph.optimise(moved, true);
  for (std::size_t s = 0; s < moved.size(); ++s) {
    const SE2 motion = row.submaps[s].T_map_submap.inverse() * moved[s].T_map_submap;
    EXPECT_LT(std::hypot(motion.x, motion.y, motion.yaw), 1e-9);
  }
}

// The chain counts a metre too much from 2 to 3, which the loop from 1 to 3 has corrected. It stays
// corrected without submap 1.
TEST(SubmapGraph, TheOnlyLoopOfADroppedSubmapIsNotLost) {
  const Row row;
  SubmapGraph graph;
  for (std::size_t s = 0; s < 4; ++s) {
    const bool has_drifted = s == 2;
    const SE2 drift{has_drifted ? 1.0 : 0.0, 0.0, 0.0};
    graph.add_chain_edge(edge(s, s + 1, row.between(s, s + 1) * drift, has_drifted ? 0.001 : 1.0));
  }
  graph.add_loop(1, 3, row.between(1, 3), some_information(1.0));
  std::vector<Submap> corrected = row.submaps;
  graph.optimise(corrected, true);
  graph.drop_submap(1, corrected);
  corrected.erase(corrected.begin() + 1);
  ASSERT_EQ(graph.loops().size(), 1U);
  std::vector<Submap> moved = corrected;
  graph.optimise(moved, true);
  for (std::size_t s = 0; s < moved.size(); ++s) {  // a little: the loop is less certain
    EXPECT_LT(distance_m(moved[s].T_map_submap, corrected[s].T_map_submap), 0.1) << s;
  }
}

TEST(SubmapGraph, TheFirstSubmapCanBeDropped) {
  Row row;
  row.graph.drop_submap(0, row.submaps);
  row.submaps.erase(row.submaps.begin());
  const std::vector<PoseEdge2d> loops = row.graph.loops();
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].from, 0U);
  EXPECT_EQ(loops[0].to, 2U);
  EXPECT_EQ(row.graph.uncertainties(row.submaps, 0).size(), 4U);
  EXPECT_LT(row.graph.uncertainties(row.submaps, 0)[3](0, 0), 1.0);  // still joined
}

TEST(SubmapGraph, ContradictedLoopsOfADroppedSubmapAreDiscarded) {
  Row row;
  row.graph.add_loop(0, 1, row.between(0, 1) * SE2{3.0, 0.0, 0.0}, some_information(9.0));
  ASSERT_TRUE(SubmapGraph::is_outlier(row.graph.loops()[0], row.submaps));
  row.graph.drop_submap(1, row.submaps);
  row.submaps.erase(row.submaps.begin() + 1);
  const std::vector<PoseEdge2d> loops = row.graph.loops();
  ASSERT_EQ(loops.size(), 2U);  // those from 1 to 3 and 4
  for (const PoseEdge2d& loop : loops) {
    EXPECT_FALSE(SubmapGraph::is_outlier(loop, row.submaps));
  }
}

}  // namespace submap_graph_test
}  // namespace nodmap::slam2d
