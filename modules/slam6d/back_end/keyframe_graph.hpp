// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/registration/pose_graph.hpp"
#include "modules/slam6d/registration/level_ground.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"

namespace nodmap::slam6d {

/// The keyframes as nodes of a pose graph. Each is joined to the next by odometry and its match,
/// and to others by loop closures. Keyframes on level ground are held at the height, roll and pitch
/// of the map, so that no bad loop can bend it upwards.
class KeyframeGraph {
 public:
  explicit KeyframeGraph(const LevelGround& ground) : ground_(ground) {}

  void add_keyframe(bool is_level) { is_level_.push_back(is_level); }
  /// The edge from a keyframe to the next one.
  void add_step(const registration::PoseEdge3d& edge) { steps_.push_back(edge); }
  /// Adds a loop closure. `weight`: until the next optimise(); none if it is not known yet whether
  /// the other edges agree.
  void add_loop(const registration::PoseEdge3d& edge, std::optional<double> weight = std::nullopt) {
    loops_.push_back({edge, weight});
  }

  /// Drops a keyframe, which must not be the first; the indices of those after it move up. The step
  /// to it and the one from it become one. Its loops go to the keyframe to which it is joined with
  /// the greatest certainty. Covariances are added, so no edge becomes too certain.
  void drop_keyframe(std::size_t dropped);

  /// Replaces what each step measured by the motion between these poses; it stays as certain.
  void set_steps(std::span<const geometry::SE3> T_map_keyframes);

  /// The poses that fit all edges best, starting from `T_map_keyframes`; the first one stays.
  /// `graduated`: the drift may be large.
  [[nodiscard]] std::vector<geometry::SE3> optimise(std::span<const geometry::SE3> T_map_keyframes,
                                                    bool graduated);

  /// The covariance (position in m, rotation vector in rad, axes of map) of the pose of each
  /// keyframe relative to that of keyframe `from`, along the most certain path. Loops that the
  /// graph contradicts are not used.
  [[nodiscard]] std::vector<Matrix6d> uncertainties(std::span<const geometry::SE3> T_map_keyframes,
                                                    std::size_t from) const;

  [[nodiscard]] bool is_level(std::size_t keyframe) const { return is_level_[keyframe]; }
  /// The edges between successive keyframes, in the order in which they were added.
  [[nodiscard]] std::span<const registration::PoseEdge3d> steps() const { return steps_; }

  /// A loop closure, and whether the other edges agree with it.
  struct WeightedLoop {
    registration::PoseEdge3d edge;
    std::optional<double> weight = std::nullopt;  ///< in the graph, 0..1, once optimised
    [[nodiscard]] bool holds() const { return weight && *weight > 0.5; }
    [[nodiscard]] bool is_contradicted() const { return weight && !holds(); }
  };
  [[nodiscard]] std::span<const WeightedLoop> loops() const { return loops_; }
  /// Number of loops, and how many of them the graph contradicts.
  [[nodiscard]] std::size_t num_loops() const { return loops_.size(); }
  [[nodiscard]] std::size_t num_contradicted() const;

 private:
  [[nodiscard]] std::vector<WeightedLoop> take_loops_of(std::size_t keyframe);
  /// The steps between a keyframe other than the first and its neighbours, all from it.
  [[nodiscard]] std::vector<registration::PoseEdge3d> steps_of(std::size_t keyframe) const;
  void join(const WeightedLoop& loop);
  void hold_level(std::span<Matrix6d> covariances, std::size_t from) const;
  [[nodiscard]] Matrix6d level_information() const;
  [[nodiscard]] registration::PoseEdge3d level_edge(std::span<const geometry::SE3> T_map_keyframes,
                                                    std::size_t keyframe) const;

  LevelGround ground_;
  std::vector<bool> is_level_;  // each keyframe
  std::vector<registration::PoseEdge3d> steps_;
  std::vector<WeightedLoop> loops_;
};

}  // namespace nodmap::slam6d
