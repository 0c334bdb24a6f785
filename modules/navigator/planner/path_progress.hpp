// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/time.hpp"
#include "modules/navigator/planner/patience.hpp"

namespace nodmap::navigator {

/// Whether the robot comes nearer to its goal by the planned path. If it does not for as long as
/// its Patience lasts, the plan must be wrong about what is ahead, and that path is given up.
///
/// When new obstacles have made the path longer the count begins anew. But a plan may alternate
/// between two paths: it shows a gap as wide enough from here and as too narrow from there. Where
/// the robot goes back and forth between them, it makes no progress either: a longer path counts as
/// a new one only elsewhere.
class PathProgress {
 public:
  /// After this long without progress the path is given up.
  static constexpr time::Duration kPatience = 12s;

  /// Adds a decision, at `p_map`, by a plan of which `cost_m` is left. Returns true if the path is
  /// to be given up.
  [[nodiscard]] bool gives_up(time::Timestamp stamp, const Eigen::Vector2d& p_map, double cost_m);

  /// There is no path, or somebody is in the way: the count begins anew.
  void restart() { patience_.end(); }

  /// The goal is a new one.
  void reset() { *this = {}; }

 private:
  Patience patience_{kPatience};
  double least_cost_m_ = 0.0;  // since the count began
  double last_cost_m_ = 0.0;
  bool is_longer_ = false;  // the plan leads along a longer path than when the count began
  std::optional<Eigen::Vector2d> longer_from_map_;  // where a longer path last began a new count
};

}  // namespace nodmap::navigator
