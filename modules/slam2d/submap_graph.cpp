// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap_graph.hpp"

#include <algorithm>
#include <iterator>

#include "common/registration/pose_edges.hpp"

namespace nodmap::slam2d {

using geometry::SE2;
using registration::covariance_of;
using registration::PoseEdge2d;
using registration::PoseGraph2d;
using registration::size_of;

void SubmapGraph::add_loop(std::size_t from, std::size_t to, const SE2& T_from_to,
                           const Eigen::Matrix3d& information) {
  auto [place, is_new] = loops_.try_emplace({from, to});
  LoopSum& sum = place->second;
  if (is_new) {
    sum.T_from_to = T_from_to;
  }
  const Eigen::Vector3d offset(T_from_to.x - sum.T_from_to.x, T_from_to.y - sum.T_from_to.y,
                               geometry::angle_difference(T_from_to.yaw, sum.T_from_to.yaw));
  sum.information += information;
  sum.weighted_offset += information * offset;
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
  std::ranges::copy(loops(), std::back_inserter(edges));
  for (PoseEdge2d& edge : edges) {
    edge.information /= variance_factor_.value();
  }
  return edges;
}

std::vector<PoseEdge2d> SubmapGraph::loops() const {
  std::vector<PoseEdge2d> edges;
  edges.reserve(loops_.size());
  for (const auto& [pair, loop] : loops_) {
    const Eigen::Vector3d offset = covariance_of(loop.information) * loop.weighted_offset;
    PoseEdge2d edge;
    edge.from = pair.first;
    edge.to = pair.second;
    edge.T_from_to = {loop.T_from_to.x + offset.x(), loop.T_from_to.y + offset.y(),
                      geometry::normalize_angle(loop.T_from_to.yaw + offset.z())};
    edge.information = loop.information;
    edge.may_be_wrong = true;
    edges.push_back(edge);
  }
  return edges;
}

bool SubmapGraph::is_outlier(const PoseEdge2d& edge, std::span<const Submap> submaps) const {
  const Eigen::Vector3d error =
      registration::residual(edge, submaps[edge.from].T_map_submap, submaps[edge.to].T_map_submap);
  return error.dot(edge.information * error) >
         variance_factor_.value() * registration::PoseSpace<SE2>::kInlierChiSquared;
}

// All loops of a submap, each from it to the other; they are no longer in the graph.
std::vector<PoseEdge2d> SubmapGraph::take_loops_of(std::size_t submap) {
  std::vector<PoseEdge2d> taken;
  for (const PoseEdge2d& edge : loops()) {
    if (edge.from == submap || edge.to == submap) {
      taken.push_back(edge.from == submap ? edge : reversed(edge));
      loops_.erase({edge.from, edge.to});
    }
  }
  return taken;
}

// Covariances are added along the path, so no edge becomes too certain. Of two edges between the
// same submaps the more certain one is kept, because fusing them could count the same loop
// repeatedly.
void SubmapGraph::join(const PoseEdge2d& edge) {
  const PoseEdge2d forward = edge.from < edge.to ? edge : reversed(edge);
  LoopSum& loop = loops_[{forward.from, forward.to}];
  if (size_of(covariance_of(forward.information)) < size_of(covariance_of(loop.information))) {
    loop = {forward.T_from_to, forward.information, Eigen::Vector3d::Zero()};
  }
}

void SubmapGraph::drop_submap(std::size_t dropped, std::span<const Submap> submaps) {
  std::vector<PoseEdge2d> loops = take_loops_of(dropped);
  std::erase_if(loops, [&](const PoseEdge2d& edge) { return is_outlier(edge, submaps); });
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
      join(composed(reversed(surest), edge));
    }
  }
  // Otherwise nothing would join the chain to where the loop leads.
  if (surest.to + 1 != dropped && surest.to != dropped + 1) {
    join(composed(reversed(surest), in_chain));
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
  std::map<std::pair<std::size_t, std::size_t>, LoopSum> renumbered;
  for (const auto& [pair, loop] : loops_) {
    renumbered[{moved_up(pair.first), moved_up(pair.second)}] = loop;
  }
  loops_ = std::move(renumbered);
}

void SubmapGraph::optimise(std::span<Submap> submaps, bool graduated) const {
  PoseGraph2d graph;
  for (const Submap& submap : submaps) {
    graph.add_node(submap.T_map_submap);
  }
  for (const PoseEdge2d& edge : edges()) {
    graph.add_edge(edge);
  }
  graph.optimise(graduated, graduated ? 60 : 2);
  for (std::size_t s = 0; s < submaps.size(); ++s) {
    submaps[s].T_map_submap = graph.nodes()[s];
  }
}

}  // namespace nodmap::slam2d
