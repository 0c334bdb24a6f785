// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap_graph.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>
#include <limits>

namespace nodmap::slam2d {

using registration::PoseEdge2d;
using registration::PoseGraph2d;
namespace {

// The size of a covariance as one number, m^2: the variance of the position plus that of a point 5
// m away due to the heading.
double size_of(const Eigen::Matrix3d& covariance) {
  constexpr double kYawMomentArmM = 5.0;
  return covariance(0, 0) + covariance(1, 1) + kYawMomentArmM * kYawMomentArmM * covariance(2, 2);
}

}  // namespace

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

namespace {

// The inverse of covariance_of(): directions that were unknown are unknown again.
Eigen::Matrix3d information_of(const Eigen::Matrix3d& covariance) {
  constexpr double kUnknown = 1e4;  // covariance_of() gives 1e6 for an unknown direction
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Vector3d information = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double variance = solver.eigenvalues()[k];
    information[k] = variance < kUnknown ? 1.0 / std::max(variance, 1e-9) : 0.0;
  }
  return solver.eigenvectors() * information.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

PoseEdge2d composed(const PoseEdge2d& a_b, const PoseEdge2d& b_c) {
  PoseEdge2d edge;
  edge.from = a_b.from;
  edge.to = b_c.to;
  edge.T_from_to = a_b.T_from_to * b_c.T_from_to;
  edge.may_be_wrong = a_b.may_be_wrong || b_c.may_be_wrong;
  const Eigen::Matrix3d J =
      moment_arm_jacobian(edge.T_from_to.translation() - a_b.T_from_to.translation());
  edge.information = information_of(J * covariance_of(a_b.information) * J.transpose() +
                                    rotated(covariance_of(b_c.information), a_b.T_from_to.yaw));
  return edge;
}

PoseEdge2d reversed(const PoseEdge2d& edge) {
  PoseEdge2d back = edge;
  back.from = edge.to;
  back.to = edge.from;
  back.T_from_to = edge.T_from_to.inverse();
  // A motion of `from`, as `to` sees it.
  const Eigen::Matrix3d J = moment_arm_jacobian(-edge.T_from_to.translation());
  back.information = rotated(information_of(J * covariance_of(edge.information) * J.transpose()),
                             -edge.T_from_to.yaw);
  return back;
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
    // Seen from `to`, the heading of the step moves `from`.
    const Eigen::Matrix3d J = moment_arm_jacobian(submaps[from].T_map_submap.translation() -
                                                  submaps[to].T_map_submap.translation());
    neighbours[to].push_back({from, J * covariance * J.transpose()});
  };
  for (const PoseEdge2d& edge : chain_) {
    join(edge.from, edge.to, edge.information);
  }
  for (const auto& [pair, loop] : loops_) {
    join(pair.first, pair.second, loop.information);
  }
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

bool SubmapGraph::is_outlier(const PoseEdge2d& edge, std::span<const Submap> submaps) {
  const Eigen::Vector3d error =
      registration::residual(edge, submaps[edge.from].T_map_submap, submaps[edge.to].T_map_submap);
  return error.dot(edge.information * error) >
         registration::PoseSpace<geometry::SE2>::kInlierChiSquared;
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
  const auto is_surer = [](const PoseEdge2d& edge, const PoseEdge2d& other) {
    return size_of(covariance_of(edge.information)) < size_of(covariance_of(other.information));
  };
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
