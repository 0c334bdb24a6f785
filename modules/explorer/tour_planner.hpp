// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/explorer/frontiers.hpp"
#include "modules/explorer/params.hpp"
#include "modules/explorer/shortest_paths.hpp"
#include "modules/explorer/viewpoints.hpp"

namespace nodmap::explorer {

/// What a tour depends on beside the map.
struct TourRequest {
  geometry::SE2 T_map_base{};                                       ///< where it begins
  Eigen::Vector2d home_map = Eigen::Vector2d::Zero();               ///< where it ends
  std::optional<Eigen::Vector2d> target_map{};                      ///< the viewpoint driven to now
  double min_gain_m2 = 0.0;                                         ///< of a viewpoint
  std::function<bool(const Eigen::Vector2d& p_map)> is_left_out{};  ///< empty: no place is
};

/// Plans a tour over the viewpoints from which the robot would see the most unknown ground.
class TourPlanner {
 public:
  explicit TourPlanner(const ExplorerParams& params);

  /// The viewpoints in the order of the visits; empty if none shows enough. `reach`: the map, and
  /// the paths from the robot.
  [[nodiscard]] std::vector<Viewpoint> plan(const Reach& reach, const TourRequest& request);

  /// The frontier cells of the last plan().
  [[nodiscard]] const std::vector<Cell>& frontier_cells() const { return frontiers_.cells(); }

 private:
  [[nodiscard]] std::vector<Viewpoint> nearest_frontier(const Reach& reach,
                                                        const TourRequest& request,
                                                        const std::vector<Cell>& lookouts);
  [[nodiscard]] std::vector<Viewpoint> in_order(const Reach& reach, const TourRequest& request,
                                                const std::vector<Viewpoint>& viewpoints);

  ExplorerParams params_;
  Frontiers frontiers_;
  ViewpointChooser chooser_;
  ShortestPaths paths_between_;  // from one viewpoint to the others
};

}  // namespace nodmap::explorer
