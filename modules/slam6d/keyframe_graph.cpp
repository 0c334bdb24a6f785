// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/keyframe_graph.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using registration::PoseEdge3d;
using registration::PoseGraph3d;

// Iterations: few suffice after a small change; after a large one the kernel must narrow.
constexpr int kFewIterations = 5;
constexpr int kManyIterations = 60;

// The inverse of an information matrix, finite also along degenerate directions.
Matrix6d covariance_of(const Matrix6d& information) {
  return (information + 1e-6 * Matrix6d::Identity()).inverse();
}

// The size of a covariance as one number: the variance of a point 5 m away.
double size_of(const Matrix6d& covariance) {
  constexpr double kMomentArmM = 5.0;
  return covariance.topLeftCorner<3, 3>().trace() +
         kMomentArmM * kMomentArmM * covariance.bottomRightCorner<3, 3>().trace();
}

}  // namespace

std::vector<SE3> KeyframeGraph::optimise(std::span<const SE3> T_map_keyframes, bool graduated) {
  PoseGraph3d graph;
  for (const SE3& T_map_keyframe : T_map_keyframes) {
    graph.add_node(T_map_keyframe);
  }
  for (const PoseEdge3d& edge : steps_) {
    graph.add_edge(edge);
  }
  for (const WeightedLoop& loop : loops_) {
    graph.add_edge(loop.edge);
  }
  for (std::size_t k = 1; k < T_map_keyframes.size(); ++k) {
    if (is_level_[k]) {
      graph.add_edge(level_edge(T_map_keyframes, k));
    }
  }
  graph.optimise(graduated, graduated ? kManyIterations : kFewIterations);
  for (WeightedLoop& loop : loops_) {
    loop.weight = graph.weight(loop.edge);
  }
  return {graph.nodes().begin(), graph.nodes().end()};
}

std::size_t KeyframeGraph::num_contradicted() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      loops_, [](const WeightedLoop& loop) { return loop.is_contradicted(); }));
}

// The information of height, roll and pitch, axes of map.
Matrix6d KeyframeGraph::level_information() const {
  Eigen::Matrix<double, 6, 1> information = Eigen::Matrix<double, 6, 1>::Zero();
  information[2] = 1.0 / (ground_.height_m * ground_.height_m);
  information[3] = information[4] = 1.0 / (ground_.tilt_rad * ground_.tilt_rad);
  return information.asDiagonal();
}

// An edge from the first keyframe, which is fixed, to where this one would be on level ground.
PoseEdge3d KeyframeGraph::level_edge(std::span<const SE3> T_map_keyframes,
                                     std::size_t keyframe) const {
  SE3 T_map_level = T_map_keyframes[keyframe];
  T_map_level.translation().z() = 0.0;
  const Eigen::Vector3d up = T_map_level.linear().col(2);
  T_map_level.linear() =
      geometry::rotation_between(up, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      T_map_level.linear();
  const SE3& T_map_first = T_map_keyframes[0];
  return {.from = 0,
          .to = keyframe,
          .T_from_to = T_map_first.inverse() * T_map_level,
          .information = rotated(level_information(), T_map_first.linear().transpose()),
          .may_be_wrong = true};
}

KeyframeGraph::Neighbours KeyframeGraph::neighbours(std::span<const SE3> T_map_keyframes) const {
  Neighbours neighbours(T_map_keyframes.size());
  const auto join = [&](const PoseEdge3d& edge) {
    const Matrix6d covariance =
        rotated(covariance_of(edge.information), T_map_keyframes[edge.from].linear());
    neighbours[edge.from].push_back({edge.to, covariance});
    neighbours[edge.to].push_back({edge.from, covariance});
  };
  std::ranges::for_each(steps_, join);
  for (const WeightedLoop& loop : loops_) {
    if (loop.holds()) {
      join(loop.edge);
    }
  }
  return neighbours;
}

// Dijkstra's algorithm by the size of the covariance (Olson 2008, section 4.2.3). Paths are not
// fused, so no covariance comes out too small.
std::vector<Matrix6d> KeyframeGraph::uncertainties(std::span<const SE3> T_map_keyframes,
                                                   std::size_t from) const {
  const Neighbours all = neighbours(T_map_keyframes);
  std::vector<Matrix6d> found(all.size(), Matrix6d::Identity() * 1e6);
  std::vector<double> size(all.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> done(all.size(), false);
  std::vector<std::pair<double, std::size_t>> open;  // a heap, the smallest on top
  const auto reach = [&](std::size_t keyframe, const Matrix6d& covariance) {
    if (size_of(covariance) < size[keyframe]) {
      size[keyframe] = size_of(covariance);
      found[keyframe] = covariance;
      open.emplace_back(size[keyframe], keyframe);
      std::ranges::push_heap(open, std::greater<>());
    }
  };
  reach(from, Matrix6d::Zero());
  while (!open.empty()) {
    std::ranges::pop_heap(open, std::greater<>());
    const std::size_t at = open.back().second;
    open.pop_back();
    if (done[at]) {
      continue;
    }
    done[at] = true;
    for (const Neighbour& next : all[at]) {
      const Matrix6d J = moment_arm_jacobian(T_map_keyframes[next.keyframe].translation() -
                                             T_map_keyframes[at].translation());
      reach(next.keyframe, J * found[at] * J.transpose() + next.covariance_map);
    }
  }
  hold_level(found, from);
  return found;
}

// On level ground both are at one height, and equally tilted.
void KeyframeGraph::hold_level(std::span<Matrix6d> covariances, std::size_t from) const {
  const Matrix6d level = 0.5 * level_information();
  for (std::size_t k = 0; k < covariances.size(); ++k) {
    if (is_level_[k] && is_level_[from] && k != from) {
      covariances[k] = (covariances[k].inverse() + level).inverse();
    }
  }
}

}  // namespace nodmap::slam6d
