// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/polish_graph.hpp"

#include <cmath>

#include "common/registration/pose_edges.hpp"

namespace nodmap::slam2d {

using registration::PoseEdge2d;
using registration::PoseGraph2d;
namespace {

constexpr std::size_t kNeighbours = 3;  // submaps that a keyframe is matched against
constexpr int kIterations = 20;

// The match as an edge from the nearest keyframe of the submap, since the graph may bend what lies
// between.
PoseEdge2d edge_to_nearest(const Submap& submap, const Loop& loop, std::size_t keyframe) {
  std::size_t nearest = submap.first_keyframe;
  for (std::size_t k = nearest; k < submap.end_keyframe(); ++k) {
    if (geometry::distance_m(submap.pose_of(k), loop.T_submap_keyframe) <
        geometry::distance_m(submap.pose_of(nearest), loop.T_submap_keyframe)) {
      nearest = k;
    }
  }
  PoseEdge2d edge;
  edge.from = nearest;
  edge.to = keyframe;
  edge.T_from_to = submap.pose_of(nearest).inverse() * loop.T_submap_keyframe;
  edge.information = registration::rotated(loop.information, -submap.pose_of(nearest).yaw);
  edge.may_be_wrong = true;
  return edge;
}

}  // namespace

std::vector<geometry::SE2> PolishGraph::polished(const LoopCloser& closer,
                                                 double max_distance_m) const {
  PoseGraph2d graph;
  for (const Keyframe& keyframe : keyframes) {
    graph.add_node(keyframe.T_map_base);
  }
  for (const PoseEdge2d& edge : chain) {
    graph.add_edge(edge);
  }
  for (const PoseEdge2d& edge : matches(closer, max_distance_m)) {
    graph.add_edge(edge);
  }
  graph.optimise(false, kIterations);
  return {graph.nodes().begin(), graph.nodes().end()};
}

std::vector<PoseEdge2d> PolishGraph::matches(const LoopCloser& closer,
                                             double max_distance_m) const {
  std::vector<PoseEdge2d> edges;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const std::vector<OrientedPoint> scan = some_points(keyframes[k]);
    std::size_t matched = 0;
    for (const NearbySubmap& near :
         nearest_submaps(submaps, keyframes, keyframes[k].T_map_base.translation(), max_distance_m,
                         submaps.size())) {
      const Submap& submap = submaps[near.submap];
      if (submap.has(k) || matched == kNeighbours) {
        continue;
      }
      ++matched;
      const Loop loop = closer.track({near.submap, k, scan}, submap,
                                     submap.T_map_submap.inverse() * keyframes[k].T_map_base);
      if (loop.state == LoopState::kAccepted) {
        edges.push_back(edge_to_nearest(submap, loop, k));
      }
    }
  }
  return edges;
}

}  // namespace nodmap::slam2d
