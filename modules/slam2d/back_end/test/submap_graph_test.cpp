// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace nodmap::slam2d {
namespace submap_graph_test {

using geometry::SE2;
using registration::PoseEdge2d;

Eigen::Matrix3d some_information(double scale) {
  Eigen::Matrix3d root;
  root << 10.0, 2.0, -3.0, 0.0, 20.0, 5.0, 0.0, 0.0, 30.0;
  return scale * root * root.transpose();
}

PoseEdge2d edge(std::size_t from, std::size_t to, const SE2& T_from_to, double scale = 1.0) {
  return {from, to, T_from_to, some_information(scale), false};
}

// Adds a loop that agrees with the graph as well as expected.
void add_loop(SubmapGraph& graph, const PoseEdge2d& edge) {
  graph.add_loop(edge, 0.8, 3.0);
}

std::vector<PoseEdge2d> loop_edges(const SubmapGraph& graph) {
  std::vector<PoseEdge2d> edges;
  for (const SavedMap::Loop& loop : graph.accepted_loops()) {
    edges.push_back(loop.edge);
  }
  return edges;
}

std::int64_t num_outliers(const SubmapGraph& graph, const std::vector<Submap>& submaps) {
  return std::ranges::count(graph.loops(submaps), LoopState::kOutlier, &SubmapLoop::state);
}

// As after many loops that contradicted the graph.
VarianceFactor large_variance_factor() {
  VarianceFactor factor;
  for (int i = 0; i < 100; ++i) {
    factor.add(1e4);
  }
  return factor;
}

// Five submaps in a row, with loops from 1 to 3 and 4.
struct Row {
  explicit Row(const VarianceFactor& variance_factor = {}) {
    graph.restore({}, {}, variance_factor);
    for (std::size_t s = 0; s < 5; ++s) {
      const auto steps = static_cast<double>(s);
      submaps.emplace_back(10 * s, SE2{2.0 * steps, 0.3 * steps * steps, 0.4 * steps}, MapParams{});
    }
    for (std::size_t s = 0; s < 4; ++s) {
      graph.add_chain_edge(edge(s, s + 1, between(s, s + 1)));
    }
    add_loop(graph, edge(1, 3, between(1, 3), 4.0));
    add_loop(graph, edge(1, 4, between(1, 4), 1.0));
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
  const std::vector<PoseEdge2d> loops = loop_edges(row.graph);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].from, 1U);
  EXPECT_EQ(loops[0].to, 2U);
  EXPECT_EQ(loops[1].from, 2U);
  EXPECT_EQ(loops[1].to, 3U);
  EXPECT_EQ(num_outliers(row.graph, row.submaps), 0);
  // The loops are less certain than before, because they lead through the dropped submap and
  // covariances add up.
  EXPECT_LT(loops[0].information.trace(), some_information(4.0).trace());
  EXPECT_LT(loops[1].information.trace(), some_information(1.0).trace());
  // Poses that agreed with all edges still agree, so nothing moves.
  const std::vector<SE2> moved = row.graph.optimised(row.submaps, true);
  for (std::size_t s = 0; s < moved.size(); ++s) {
    const SE2 motion = row.submaps[s].T_map_submap.inverse() * moved[s];
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
  add_loop(graph, edge(1, 3, row.between(1, 3)));
  std::vector<Submap> corrected = row.submaps;
  const std::vector<SE2> optimised = graph.optimised(corrected, true);
  for (std::size_t s = 0; s < corrected.size(); ++s) {
    corrected[s].T_map_submap = optimised[s];
  }
  graph.drop_submap(1, corrected);
  corrected.erase(corrected.begin() + 1);
  ASSERT_EQ(graph.accepted_loops().size(), 1U);
  const std::vector<SE2> moved = graph.optimised(corrected, true);
  for (std::size_t s = 0; s < moved.size(); ++s) {  // a little: the loop is less certain
    EXPECT_LT(distance_m(moved[s], corrected[s].T_map_submap), 0.1) << s;
  }
}

TEST(SubmapGraph, TheFirstSubmapCanBeDropped) {
  Row row;
  row.graph.drop_submap(0, row.submaps);
  row.submaps.erase(row.submaps.begin());
  const std::vector<PoseEdge2d> loops = loop_edges(row.graph);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].from, 0U);
  EXPECT_EQ(loops[0].to, 2U);
  EXPECT_EQ(row.graph.uncertainties(row.submaps, 0).size(), 4U);
  EXPECT_LT(row.graph.uncertainties(row.submaps, 0)[3](0, 0), 1.0);  // still joined
}

// What contradicts poses that are surer than they should be need not be wrong.
TEST(SubmapGraph, WhatIsAnOutlierDependsOnTheVarianceFactor) {
  for (const bool is_large : {false, true}) {
    Row row(is_large ? large_variance_factor() : VarianceFactor{});
    add_loop(row.graph, edge(0, 1, row.between(0, 1) * SE2{3.0, 0.0, 0.0}, 9.0));
    EXPECT_EQ(num_outliers(row.graph, row.submaps), is_large ? 0 : 1);
  }
}

TEST(SubmapGraph, ContradictedLoopsOfADroppedSubmapAreDiscarded) {
  Row row;
  row.graph.add_loop(edge(0, 1, row.between(0, 1) * SE2{3.0, 0.0, 0.0}, 9.0), 0.95, 3.0);
  ASSERT_EQ(num_outliers(row.graph, row.submaps), 1);
  row.graph.drop_submap(1, row.submaps);
  row.submaps.erase(row.submaps.begin() + 1);
  EXPECT_EQ(row.graph.accepted_loops().size(), 2U);  // those from 1 to 3 and 4
  for (const SavedMap::Loop& loop : row.graph.accepted_loops()) {
    EXPECT_EQ(loop.score, 0.8) << "not that of the discarded one";
  }
  EXPECT_EQ(num_outliers(row.graph, row.submaps), 0);
}

// Those of the dropped one vanish, others keep their state, and an accepted loop that is handed on
// takes the place of a refused one.
TEST(SubmapGraph, RefusedLoopsStayWithTheirSubmapsWhenOneIsDropped) {
  Row row;
  row.graph.record_try({0, 1, LoopState::kAmbiguous, 0.1});
  row.graph.record_try({0, 3, LoopState::kLowScore, 0.2});
  row.graph.record_try({3, 4, LoopState::kInconsistent, 0.3});
  row.graph.drop_submap(1, row.submaps);
  row.submaps.erase(row.submaps.begin() + 1);
  const std::vector<SubmapLoop> loops = row.graph.loops(row.submaps);
  ASSERT_EQ(loops.size(), 3U);
  const auto expect = [](const SubmapLoop& loop, const SubmapLoop& expected) {
    EXPECT_EQ(loop.from, expected.from);
    EXPECT_EQ(loop.to, expected.to);
    EXPECT_EQ(loop.state, expected.state);
    EXPECT_EQ(loop.score, expected.score);
  };
  expect(loops[0], {0, 2, LoopState::kLowScore, 0.2});
  expect(loops[1], {1, 2, LoopState::kAccepted, 0.8});
  expect(loops[2], {2, 3, LoopState::kAccepted, 0.8});
}

TEST(SubmapGraph, EveryAcceptedLoopIsAChange) {
  Row row;
  const std::int64_t before = row.graph.revision();
  add_loop(row.graph, edge(1, 3, row.between(1, 3)));  // the second between these submaps
  EXPECT_GT(row.graph.revision(), before);
}

// A refused loop is shown until one between the same submaps is accepted, and not in its stead.
TEST(SubmapGraph, AnAcceptedLoopReplacesARefusedOneAndNotTheOtherWayRound) {
  Row row;
  const auto state = [&row] { return row.graph.loops(row.submaps).at(0).state; };
  row.graph.record_try({0, 2, LoopState::kAmbiguous, 0.0});
  EXPECT_EQ(state(), LoopState::kAmbiguous);
  EXPECT_EQ(row.graph.accepted_loops().size(), 2U);
  row.graph.record_try({0, 2, LoopState::kInconsistent, 0.0});
  EXPECT_EQ(state(), LoopState::kInconsistent);
  add_loop(row.graph, edge(0, 2, row.between(0, 2)));
  EXPECT_EQ(state(), LoopState::kAccepted);
  EXPECT_EQ(row.graph.accepted_loops().size(), 3U);
  const std::int64_t revision = row.graph.revision();
  row.graph.record_try({0, 2, LoopState::kLowScore, 0.0});
  EXPECT_EQ(state(), LoopState::kAccepted);
  EXPECT_EQ(row.graph.revision(), revision);
}

TEST(SubmapGraph, OnlyTheFirstLoopBetweenTwoSubmapsTellsTheVariance) {
  Row row;
  for (int i = 0; i < 100; ++i) {
    row.graph.add_loop(edge(0, 2, row.between(0, 2)), 0.8, 1e4);
  }
  VarianceFactor one_loop;
  for (const double chi_squared : {3.0, 3.0, 1e4}) {
    one_loop.add(chi_squared);
  }
  EXPECT_EQ(row.graph.variance_factor().value(), one_loop.value());
}

// A long chain bends by more than its covariance allows, and two loops at its end agree on how
// much. They would lose their weight, for ever, if loops had not shown that the graph is too
// certain.
TEST(SubmapGraph, RightLoopsBendAChainThatIsTooCertain) {
  std::vector<Submap> submaps;
  std::vector<PoseEdge2d> steps;
  constexpr std::size_t kLast = 20;
  for (std::size_t s = 0; s <= kLast; ++s) {
    submaps.emplace_back(10 * s, SE2{static_cast<double>(s), 0.0, 0.0}, MapParams{});
    if (s > 0) {
      steps.push_back({s - 1, s, SE2{1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity() * 1e4, false});
    }
  }
  const SE2 drift{0.0, 1.5, 0.0};
  const auto loop = [&](std::size_t from, std::size_t to) {
    return SavedMap::Loop{{from, to, drift * SE2{static_cast<double>(to - from), 0.0, 0.0},
                           Eigen::Matrix3d::Identity() * 1e6, true},
                          0.8};
  };
  const auto error_m = [&](const VarianceFactor& variance_factor) {
    SubmapGraph graph;
    graph.restore(steps, std::vector{loop(0, 10), loop(10, kLast)}, variance_factor);
    return std::abs(graph.optimised(submaps, false)[kLast].y - 3.0);
  };
  EXPECT_GT(error_m({}), 1.0);
  EXPECT_LT(error_m(large_variance_factor()), 0.5);
}

}  // namespace submap_graph_test
}  // namespace nodmap::slam2d
