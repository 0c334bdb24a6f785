// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap_graph.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <limits>

namespace nodmap::slam2d {

using registration::PoseEdge2d;
using registration::PoseGraph2d;

Eigen::Matrix3d rotated(const Eigen::Matrix3d& matrix, double yaw_rad) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = geometry::SE2{0.0, 0.0, yaw_rad}.rotation();
  return R * matrix * R.transpose();
}

Eigen::Matrix3d covariance_of(const Eigen::Matrix3d& information) {
  return (information + 1e-6 * Eigen::Matrix3d::Identity()).inverse();
}

Eigen::Matrix3d moment_arm_jacobian(const Eigen::Vector2d& moment_arm) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = -moment_arm.y();
  J(1, 2) = moment_arm.x();
  return J;
}

void SubmapGraph::add_loop(std::size_t from, std::size_t to, const geometry::SE2& T_from_to,
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

// Dijkstra's algorithm on the graph of the submaps, by the size of the covariance (Olson 2008,
// section 4.2.3). Paths are not fused, so no covariance comes out too small.
std::vector<Eigen::Matrix3d> SubmapGraph::uncertainties(std::span<const Submap> submaps,
                                                        std::size_t local) const {
  struct Neighbour {
    std::size_t submap;
    Eigen::Matrix3d covariance_map;  // of the step, in map
  };
  std::vector<std::vector<Neighbour>> neighbours(submaps.size());
  const auto join = [&](std::size_t from, std::size_t to, const Eigen::Matrix3d& information) {
    const Eigen::Matrix3d covariance =
        rotated(covariance_of(information), submaps[from].T_map_submap.yaw);
    neighbours[from].push_back({to, covariance});
    neighbours[to].push_back({from, covariance});
  };
  for (const PoseEdge2d& edge : chain_) {
    join(edge.from, edge.to, edge.information);
  }
  for (const auto& [pair, loop] : loops_) {
    join(pair.first, pair.second, loop.information);
  }
  constexpr double kYawMomentArmM = 5.0;
  const auto size_of = [](const Eigen::Matrix3d& covariance) {
    return covariance(0, 0) + covariance(1, 1) + kYawMomentArmM * kYawMomentArmM * covariance(2, 2);
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Eigen::Matrix3d> found(submaps.size(), Eigen::Matrix3d::Identity() * 1e6);
  std::vector<double> size(submaps.size(), kInfinity);
  std::vector<bool> done(submaps.size(), false);
  std::vector<std::pair<double, std::size_t>> open;  // a heap, the smallest on top
  found[local].setZero();
  size[local] = 0.0;
  open.emplace_back(0.0, local);
  while (!open.empty()) {
    std::pop_heap(open.begin(), open.end(), std::greater<>());
    const std::size_t at = open.back().second;
    open.pop_back();
    if (done[at]) {
      continue;
    }
    done[at] = true;
    for (const Neighbour& next : neighbours[at]) {
      const Eigen::Matrix3d J = moment_arm_jacobian(
          submaps[next.submap].T_map_submap.translation() - submaps[at].T_map_submap.translation());
      const Eigen::Matrix3d covariance = J * found[at] * J.transpose() + next.covariance_map;
      if (size_of(covariance) < size[next.submap]) {
        size[next.submap] = size_of(covariance);
        found[next.submap] = covariance;
        open.emplace_back(size[next.submap], next.submap);
        std::push_heap(open.begin(), open.end(), std::greater<>());
      }
    }
  }
  return found;
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

void SubmapGraph::optimise(std::span<Submap> submaps, bool graduated) const {
  PoseGraph2d graph;
  for (const Submap& submap : submaps) {
    graph.add_node(submap.T_map_submap);
  }
  for (const PoseEdge2d& edge : chain_) {
    graph.add_edge(edge);
  }
  for (const PoseEdge2d& edge : loops()) {
    graph.add_edge(edge);
  }
  graph.optimise(graduated, graduated ? 60 : 2);
  for (std::size_t s = 0; s < submaps.size(); ++s) {
    submaps[s].T_map_submap = graph.nodes()[s];
  }
}

}  // namespace nodmap::slam2d
