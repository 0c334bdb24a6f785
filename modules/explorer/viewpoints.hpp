// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "modules/explorer/params.hpp"
#include "modules/explorer/planning_grid.hpp"
#include "modules/explorer/ray_caster.hpp"
#include "modules/explorer/shortest_paths.hpp"

namespace nodmap::explorer {

/// A place from which the robot would see unknown ground.
struct Viewpoint {
  Cell cell = Cell::Zero();
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  double gain_m2 = 0.0;   ///< unknown area that no previously chosen viewpoint shows
  double length_m = 0.0;  ///< length of the path from the robot
};

/// Viewpoints nearer to each other than this count as the same one.
inline constexpr double kSameViewpointM = 0.8;

/// Chooses viewpoints among lookouts.
class ViewpointChooser {
 public:
  explicit ViewpointChooser(const ExplorerParams& params);

  /// Chooses at most tour.max_viewpoints viewpoints, the best first, by gain discounted with the
  /// path length; cells that one viewpoint shows no longer count for the next (greedy set cover).
  /// `lookouts`: reached cells, the nearest first. `yaw_rad`: heading of the robot.
  [[nodiscard]] std::vector<Viewpoint> choose(const Reach& reach, const std::vector<Cell>& lookouts,
                                              double yaw_rad);

  /// The first lookout that shows enough in all directions together.
  [[nodiscard]] std::optional<Viewpoint> nearest(const Reach& reach,
                                                 const std::vector<Cell>& lookouts);

 private:
  struct Candidate {
    Viewpoint viewpoint;
    std::vector<std::uint32_t> shows;  // indices of unknown cells
  };
  [[nodiscard]] std::vector<Candidate> candidates_among(const Reach& reach,
                                                        const std::vector<Cell>& lookouts,
                                                        double yaw_rad);

  ExplorerParams params_;
  RayCaster ray_caster_;
  RayCaster ray_caster_around_;  // in all directions
};

}  // namespace nodmap::explorer
