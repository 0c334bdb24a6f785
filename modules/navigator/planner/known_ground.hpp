// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "modules/navigator/planner/map_2d.hpp"
#include "modules/navigator/planner/plan_window.hpp"
#include "modules/navigator/rolling_grid.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// All the ground that the local map has shown so far: a grid around the robot in map, 204 m x
/// 204 m, with cells of 5 cm (34 MB).
class KnownGround {
 public:
  static constexpr double kCellM = PlanWindow::kCellM;

  /// kCleared: an obstacle was there and is gone, but no floor was seen. kPossibleRamp: an obstacle
  /// that was only seen from afar, and no higher than a ramp would be there.
  enum class Kind : std::uint8_t { kUnknown, kFloor, kBlocked, kCleared, kPossibleRamp };

  KnownGround() : grid_(kCellM, kLog2Size) {}

  /// Copies what the local map knows around the robot. `now` must have a local map. What a level
  /// laser has measured from nearby is gone when four updates in succession show that.
  void update(const Situation& now);

  /// Makes everything unknown again.
  void forget();

  /// The window around the robot, the goal, all known ground and the 2D map, at most 51 m x 51 m
  /// with the robot in its middle.
  [[nodiscard]] PlanWindow window_around(const Eigen::Vector2d& p_map,
                                         const Eigen::Vector2d& goal_map,
                                         const Map2d* map_2d) const;

  /// The same as far as the grid reaches, with cells of 5 cm or, to have about a million of them at
  /// most, coarser ones. Empty if window_around() leaves nothing out.
  [[nodiscard]] std::optional<PlanWindow> window_of_all(const Eigen::Vector2d& p_map,
                                                        const Eigen::Vector2d& goal_map,
                                                        const Map2d* map_2d) const;

  /// The window that reaches `half_size_m` to each side of a place.
  [[nodiscard]] PlanWindow window_within(const Eigen::Vector2d& p_map, double half_size_m) const;

  /// The grid's index of a window's cell (0, 0).
  [[nodiscard]] Eigen::Vector2i first_of(const PlanWindow& window) const {
    return grid_.index_of(window.origin + Eigen::Vector2d(0.01, 0.01));
  }
  [[nodiscard]] Kind at(const Eigen::Vector2i& index) const { return grid_.at(index).kind; }
  /// Whether the local map has shown a cell within 20 cm.
  [[nodiscard]] bool is_seen_near(const Eigen::Vector2i& index) const;

 private:
  static constexpr int kLog2Size = 12;

  struct Cell {
    Kind kind = Kind::kUnknown;
    std::uint8_t until_gone = 0;  // so many updates must show that an obstacle is gone
  };

  // First and last row and column.
  struct Extent {
    Eigen::Vector2i low;
    Eigen::Vector2i high;
    [[nodiscard]] Extent within(const Extent& other) const {
      return {low.cwiseMax(other.low), high.cwiseMin(other.high)};
    }
    friend bool operator==(const Extent&, const Extent&) = default;
  };
  [[nodiscard]] Extent extent(const Eigen::Vector2d& p_map, const Eigen::Vector2d& goal_map,
                              const Map2d* map_2d) const;
  [[nodiscard]] Extent around(const Eigen::Vector2d& p_map) const;
  void update_cell(const Eigen::Vector2i& index, unsigned bits, bool could_be_ramp,
                   std::uint8_t until_gone);

  RollingGrid<Cell> grid_;
  Eigen::Vector2d known_min_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d known_max_ = Eigen::Vector2d::Zero();
  bool is_empty_ = true;
};

}  // namespace nodmap::navigator
