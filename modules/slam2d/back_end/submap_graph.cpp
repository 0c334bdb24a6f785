// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap_graph.hpp"

#include <algorithm>
#include <utility>

#include "common/registration/pose_edges.hpp"

namespace nodmap::slam2d {

using geometry::SE2;
using registration::covariance_of;
using registration::PoseEdge2d;
using registration::PoseGraph2d;
using registration::size_of;

void SubmapGraph::restore(std::vector<PoseEdge2d> chain, std::span<const SavedMap::Loop> loops,
                          const VarianceFactor& variance_factor) {
  chain_ = std::move(chain);
  variance_factor_ = variance_factor;
  for (const SavedMap::Loop& loop : loops) {
    const PoseEdge2d& edge = loop.edge;
    loops_[{edge.from, edge.to}] = {LoopState::kAccepted, loop.score, edge.T_from_to,
                                    edge.information};
  }
  ++revision_;
}

void SubmapGraph::add_chain_edge(const PoseEdge2d& edge) {
  chain_.push_back(edge);
  ++revision_;
}

void SubmapGraph::add_loop(const PoseEdge2d& edge, double score, double chi_squared) {
  LoopSum& sum = loops_[{edge.from, edge.to}];
  if (!sum.is_accepted()) {
    // Only the first one shows whether the graph is too certain: others show the same error again.
    variance_factor_.add(chi_squared);
    sum.state = LoopState::kAccepted;
    sum.T_from_to = edge.T_from_to;
  }
  const Eigen::Vector3d offset(edge.T_from_to.x - sum.T_from_to.x,
                               edge.T_from_to.y - sum.T_from_to.y,
                               geometry::angle_difference(edge.T_from_to.yaw, sum.T_from_to.yaw));
  sum.information += edge.information;
  sum.weighted_offset += edge.information * offset;
  sum.score = score;
  ++revision_;
}

void SubmapGraph::record_try(const SubmapLoop& loop) {
  const auto [place, is_new] = loops_.try_emplace({loop.from, loop.to});
  LoopSum& sum = place->second;
  if (sum.is_accepted()) {
    return;
  }
  revision_ += is_new || sum.state != loop.state ? 1 : 0;
  sum.state = loop.state;
  sum.score = loop.score;
}

std::vector<Eigen::Matrix3d> SubmapGraph::uncertainties(std::span<const Submap> submaps,
                                                        std::size_t local) const {
  std::vector<SE2> T_map_submaps;
  for (const Submap& submap : submaps) {
    T_map_submaps.push_back(submap.T_map_submap);
  }
  return registration::covariances_from<SE2>(local, T_map_submaps, edges());
}

std::vector<PoseEdge2d> SubmapGraph::edges() const {
  std::vector<PoseEdge2d> edges = chain_;
  for (const SavedMap::Loop& loop : accepted_loops()) {
    edges.push_back(loop.edge);
  }
  for (PoseEdge2d& edge : edges) {
    edge.information /= variance_factor_.value();
  }
  return edges;
}

std::vector<SavedMap::Loop> SubmapGraph::accepted_loops() const {
  std::vector<SavedMap::Loop> accepted;
  for (const auto& [pair, loop] : loops_) {
    if (loop.is_accepted()) {
      accepted.push_back({edge_of(pair, loop), loop.score});
    }
  }
  return accepted;
}

std::vector<SubmapLoop> SubmapGraph::loops(std::span<const Submap> submaps) const {
  std::vector<SubmapLoop> loops;
  loops.reserve(loops_.size());
  for (const auto& [pair, loop] : loops_) {
    const bool is_outlier = loop.is_accepted() && this->is_outlier(edge_of(pair, loop), submaps);
    loops.push_back(
        {pair.first, pair.second, is_outlier ? LoopState::kOutlier : loop.state, loop.score});
  }
  return loops;
}

PoseEdge2d SubmapGraph::edge_of(const Pair& pair, const LoopSum& loop) {
  const Eigen::Vector3d offset = covariance_of(loop.information) * loop.weighted_offset;
  PoseEdge2d edge;
  edge.from = pair.first;
  edge.to = pair.second;
  edge.T_from_to = {loop.T_from_to.x + offset.x(), loop.T_from_to.y + offset.y(),
                    geometry::normalize_angle(loop.T_from_to.yaw + offset.z())};
  edge.information = loop.information;
  edge.may_be_wrong = true;
  return edge;
}

bool SubmapGraph::is_outlier(const PoseEdge2d& edge, std::span<const Submap> submaps) const {
  const Eigen::Vector3d error =
      registration::residual(edge, submaps[edge.from].T_map_submap, submaps[edge.to].T_map_submap);
  return error.dot(edge.information * error) >
         variance_factor_.value() * registration::PoseSpace<SE2>::kInlierChiSquared;
}

// All accepted loops of a submap, each from it to the other. None of its loops stays in the graph.
std::vector<SavedMap::Loop> SubmapGraph::take_loops_of(std::size_t submap) {
  std::vector<SavedMap::Loop> taken;
  for (const auto& [edge, score] : accepted_loops()) {
    if (edge.from == submap || edge.to == submap) {
      taken.push_back({edge.from == submap ? edge : reversed(edge), score});
    }
  }
  std::erase_if(loops_, [submap](const auto& loop) {
    return loop.first.first == submap || loop.first.second == submap;
  });
  return taken;
}

// Covariances are added along the path, so no edge becomes too certain. Of two edges between the
// same submaps the more certain one is kept, because fusing them could count the same loop
// repeatedly.
void SubmapGraph::join(const PoseEdge2d& edge, double score) {
  const PoseEdge2d forward = edge.from < edge.to ? edge : reversed(edge);
  LoopSum& loop = loops_[{forward.from, forward.to}];
  if (size_of(covariance_of(forward.information)) < size_of(covariance_of(loop.information))) {
    loop = {loop.state, loop.score, forward.T_from_to, forward.information};
  }
  if (!loop.is_accepted()) {
    loop.state = LoopState::kAccepted;
    loop.score = score;
  }
}

void SubmapGraph::drop_submap(std::size_t dropped, std::span<const Submap> submaps) {
  std::vector<PoseEdge2d> loops;
  double score = 0.0;  // of the loops that get a new end
  for (const SavedMap::Loop& loop : take_loops_of(dropped)) {
    if (!is_outlier(loop.edge, submaps)) {
      score = std::max(score, loop.score);
      loops.push_back(loop.edge);
    }
  }
  PoseEdge2d in_chain = chain_[dropped];  // the last submap is never dropped
  if (dropped > 0 && is_surer(reversed(chain_[dropped - 1]), in_chain)) {
    in_chain = reversed(chain_[dropped - 1]);
  }
  PoseEdge2d surest = in_chain;
  for (const PoseEdge2d& edge : loops) {
    surest = is_surer(edge, surest) ? edge : surest;
  }
  for (const PoseEdge2d& edge : loops) {
    if (edge.to != surest.to) {
      join(composed(reversed(surest), edge), score);
    }
  }
  // Otherwise nothing would join the chain to where the loop leads.
  if (surest.to + 1 != dropped && surest.to != dropped + 1) {
    join(composed(reversed(surest), in_chain), score);
  }
  if (dropped > 0) {
    chain_[dropped - 1] = composed(chain_[dropped - 1], chain_[dropped]);
  }
  chain_.erase(chain_.begin() + static_cast<std::ptrdiff_t>(dropped));
  renumber_without(dropped);
}

void SubmapGraph::renumber_without(std::size_t dropped) {
  const auto moved_up = [dropped](std::size_t submap) {
    return submap - (submap > dropped ? 1 : 0);
  };
  for (PoseEdge2d& edge : chain_) {
    edge.from = moved_up(edge.from);
    edge.to = moved_up(edge.to);
  }
  std::map<Pair, LoopSum> renumbered;
  for (const auto& [pair, loop] : loops_) {
    renumbered[{moved_up(pair.first), moved_up(pair.second)}] = loop;
  }
  loops_ = std::move(renumbered);
  ++revision_;
}

std::vector<SE2> SubmapGraph::optimised(std::span<const Submap> submaps, bool graduated) const {
  PoseGraph2d graph;
  for (const Submap& submap : submaps) {
    graph.add_node(submap.T_map_submap);
  }
  for (const PoseEdge2d& edge : edges()) {
    graph.add_edge(edge);
  }
  graph.optimise(graduated, graduated ? 60 : 2);
  return {graph.nodes().begin(), graph.nodes().end()};
}

}  // namespace nodmap::slam2d
