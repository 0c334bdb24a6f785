// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/back_end/saved_map.hpp"
#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// Keyframes in a row that newer ones have replaced.
struct DroppedKeyframes {
  std::size_t first = 0;  ///< index before they were dropped; those after them have moved up
  std::vector<Keyframe> keyframes;
};

/// The keyframes of a drive in their submaps, and the steps from each keyframe to the next.
///
/// Two submaps grow at a time, each begun when the other is half full. So one of them always has
/// enough points to match against (Hess et al. 2016, section IV).
class SubmapChain {
 public:
  SubmapChain(const SubmapParams& params, const MapParams& map);

  /// Writes keyframes, steps and submaps.
  void save(SavedMap& map) const;
  /// Restores them; must be called before the first keyframe.
  void restore(SavedMap map);

  /// See BackEnd::begin_anew().
  void begin_anew(const Eigen::Vector3d& sigmas);

  [[nodiscard]] bool has_local() const { return local_ < submaps_.size(); }
  [[nodiscard]] const Submap& local() const { return submaps_[local_]; }
  [[nodiscard]] std::size_t local_index() const { return local_; }

  /// Adds a keyframe; for the arguments see BackEnd::add_keyframe(). At most one submap begins.
  /// Returns whether the local submap is finished: then the next one is local.
  bool add(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
           const Eigen::Matrix3d& information);

  /// The edge from the previous submap to this one.
  [[nodiscard]] registration::PoseEdge2d step_to_submap(std::size_t submap) const;

  /// Drops a submap, which must not be the last, and the keyframes that no other submap holds. The
  /// indices of those after them move up.
  DroppedKeyframes drop_submap(std::size_t dropped);

  /// Moves the submaps, and the keyframes with them.
  void move_submaps(std::span<const geometry::SE2> T_map_submaps);
  /// Sets T_map_base of each keyframe. The submaps do not move.
  void set_poses(std::span<const geometry::SE2> T_map_keyframe);
  /// Moves the first keyframes, those of about two submaps, to where the lines that they saw agree
  /// best, and their steps and submaps with them. The others stay until set_poses(). Returns false,
  /// and does nothing, the second time, and for a restored map.
  bool straighten_beginning();
  /// Rebuilds the submaps from the present poses of their keyframes.
  void rebuild_submaps();

  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] std::span<const Submap> submaps() const { return submaps_; }
  [[nodiscard]] std::span<const registration::PoseEdge2d> steps() const { return steps_; }
  /// The submap that a keyframe was matched against.
  [[nodiscard]] std::size_t submap_of(std::size_t keyframe) const { return submap_of_[keyframe]; }
  /// Loops are closed with the submaps before this index.
  [[nodiscard]] std::size_t end_finished() const;
  [[nodiscard]] std::size_t num_points() const;

 private:
  void move_keyframes();
  [[nodiscard]] bool is_full(const Submap& submap, double ratio) const;
  void begin_local();
  void insert_into_submaps(const geometry::SE2& T_local_keyframe);
  [[nodiscard]] Eigen::Matrix3d odometry_information_on_step(std::size_t to) const;
  [[nodiscard]] std::size_t end_of_beginning() const;
  void add_step(std::size_t keyframe, const geometry::SE2& T_local_keyframe,
                const Eigen::Matrix3d& information);
  [[nodiscard]] DroppedKeyframes drop_keyframes(std::size_t first, std::size_t end);
  [[nodiscard]] Submap build_submap(std::size_t first_keyframe, std::size_t end_keyframe) const;

  SubmapParams params_;
  MapParams map_params_;
  std::vector<Keyframe> keyframes_;
  std::vector<std::size_t> submap_of_;  ///< the one each keyframe was matched against
  std::vector<Submap> submaps_;
  std::size_t local_ = 0;
  bool is_beginning_straight_ = false;
  std::size_t num_separate_ = 0;  ///< submaps before the last begin_anew()
  /// Standard deviations of a submap's first pose after begin_anew(), relative to the previous
  /// keyframe: x, y in m, yaw in rad.
  Eigen::Vector3d begin_sigmas_ = Eigen::Vector3d::Zero();
  std::vector<registration::PoseEdge2d> steps_;  ///< from keyframe k to k + 1
};

}  // namespace nodmap::slam2d
