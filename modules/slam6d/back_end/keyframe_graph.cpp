// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/keyframe_graph.hpp"

#include <algorithm>
#include <iterator>

#include "common/registration/pose_edges.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using registration::PoseEdge3d;
using registration::PoseGraph3d;

// Iterations: few suffice after a small change; after a large one the kernel must narrow.
constexpr int kFewIterations = 5;
constexpr int kManyIterations = 60;
// The kernel's weight of a loop whose residual exceeds those of 99 % of correct ones.
constexpr double kOutlierWeight = 0.25;

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

// All loops of a keyframe, each from it to the other; they are no longer in the graph. Outliers are
// left out.
std::vector<KeyframeGraph::WeightedLoop> KeyframeGraph::take_loops_of(std::size_t keyframe) {
  std::vector<WeightedLoop> taken;
  std::erase_if(loops_, [&](const WeightedLoop& loop) {
    const bool is_of = loop.edge.from == keyframe || loop.edge.to == keyframe;
    if (is_of && loop.weight.value_or(1.0) > kOutlierWeight) {
      taken.push_back({loop.edge.from == keyframe ? loop.edge : reversed(loop.edge), loop.weight});
    }
    return is_of;
  });
  return taken;
}

std::vector<PoseEdge3d> KeyframeGraph::steps_of(std::size_t keyframe) const {
  std::vector<PoseEdge3d> found{reversed(steps_[keyframe - 1])};
  std::ranges::copy_if(steps_, std::back_inserter(found),
                       [keyframe](const PoseEdge3d& step) { return step.from == keyframe; });
  return found;
}

// Of two loops between the same keyframes the more certain one is kept, because fusing them could
// count the same loop repeatedly.
void KeyframeGraph::join(const WeightedLoop& loop) {
  WeightedLoop forward{loop.edge.from < loop.edge.to ? loop.edge : reversed(loop.edge),
                       loop.weight};
  forward.edge.may_be_wrong = true;
  const auto same = std::ranges::find_if(loops_, [&forward](const WeightedLoop& other) {
    return other.edge.from == forward.edge.from && other.edge.to == forward.edge.to;
  });
  if (same == loops_.end()) {
    loops_.push_back(forward);
  } else if (is_surer(forward.edge, same->edge)) {
    *same = forward;
  }
}

void KeyframeGraph::drop_keyframe(std::size_t dropped) {
  const std::vector<WeightedLoop> loops = take_loops_of(dropped);
  const std::vector<PoseEdge3d> steps = steps_of(dropped);
  const PoseEdge3d surest_step = *std::ranges::min_element(steps, registration::is_surer<SE3>);
  const auto surest_loop = std::ranges::min_element(
      loops, registration::is_surer<SE3>, [](const WeightedLoop& loop) { return loop.edge; });
  const bool is_by_loop = !loops.empty() && is_surer(surest_loop->edge, surest_step);
  const PoseEdge3d back = reversed(is_by_loop ? surest_loop->edge : surest_step);
  for (const WeightedLoop& loop : loops) {
    if (loop.edge.to != back.from) {
      join({composed(back, loop.edge), loop.weight});
    }
  }
  // Otherwise nothing would join the chain to where the loop leads.
  const bool is_in_chain =
      std::ranges::any_of(steps, [&back](const PoseEdge3d& step) { return step.to == back.from; });
  if (!is_in_chain) {
    join({composed(back, surest_step), surest_loop->weight});
  }
  const PoseEdge3d step_to_dropped = steps_[dropped - 1];
  steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(dropped) - 1);
  is_level_.erase(is_level_.begin() + static_cast<std::ptrdiff_t>(dropped));
  const auto renumber = [dropped](PoseEdge3d& edge) {
    edge.from -= edge.from > dropped ? 1 : 0;
    edge.to -= edge.to > dropped ? 1 : 0;
  };
  for (PoseEdge3d& step : steps_) {
    step = step.from == dropped ? composed(step_to_dropped, step) : step;
    renumber(step);
  }
  for (WeightedLoop& loop : loops_) {
    renumber(loop.edge);
  }
}

void KeyframeGraph::set_steps(std::span<const SE3> T_map_keyframes) {
  for (PoseEdge3d& step : steps_) {
    step.T_from_to = T_map_keyframes[step.from].inverse() * T_map_keyframes[step.to];
  }
}

// The information of height, roll and pitch, axes of map.
Matrix6d KeyframeGraph::level_information() const {
  Vector6d information = Vector6d::Zero();
  information[2] = 1.0 / (ground_.height_sigma_m * ground_.height_sigma_m);
  information[3] = information[4] = 1.0 / (ground_.tilt_sigma_rad * ground_.tilt_sigma_rad);
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
  return {
      .from = 0,
      .to = keyframe,
      .T_from_to = T_map_first.inverse() * T_map_level,
      .information = registration::rotated(level_information(), T_map_first.linear().transpose()),
      .may_be_wrong = true};
}

std::vector<Matrix6d> KeyframeGraph::uncertainties(std::span<const SE3> T_map_keyframes,
                                                   std::size_t from) const {
  std::vector<PoseEdge3d> edges = steps_;
  for (const WeightedLoop& loop : loops_) {
    if (loop.holds()) {
      edges.push_back(loop.edge);
    }
  }
  std::vector<Matrix6d> found = registration::covariances_from<SE3>(from, T_map_keyframes, edges);
  hold_level(found, from);
  return found;
}

// On level ground both are at one height, and equally tilted.
void KeyframeGraph::hold_level(std::span<Matrix6d> covariances, std::size_t from) const {
  const Matrix6d level = 0.5 * level_information();
  for (std::size_t k = 0; k < covariances.size(); ++k) {
    if (is_level_[k] && is_level_[from] && k != from) {
      const Matrix6d information = registration::inverse(covariances[k]) + level;
      covariances[k] = registration::inverse(information);
    }
  }
}

}  // namespace nodmap::slam6d
