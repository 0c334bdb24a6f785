// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/geometry/map_tile.hpp"
#include "modules/explorer/raster.hpp"

namespace nodmap::explorer {

using geometry::MapTile;

/// In this order: the greatest of several cells counts.
enum class Ground : std::uint8_t { kUnknown, kFree, kOccupied };

/// The 2D map for planning: planning cells of 2 x 2 map cells, each unknown, free or occupied, and
/// whether the robot's centre can be there. Each tile updates the grid at a cost that depends on
/// the tile, not on the building. Frame map.
///
/// A gap of one planning cell between free cells is free, because the beams of a scan are 14 cm
/// apart at 8 m. A gap of up to three between occupied cells is occupied, because a wall seen at a
/// grazing angle has cells in which no beam ended.
class PlanningGrid {
 public:
  /// The largest map, in planning cells: 410 m x 410 m at 10 cm.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 24;

  /// `inflation_radius_m`: distance that the robot's centre keeps from the middles of occupied map
  /// cells.
  explicit PlanningGrid(double inflation_radius_m) : inflation_radius_m_(inflation_radius_m) {}

  /// Adds a tile. Returns false and changes nothing if the map would become too large, the tile
  /// contradicts itself, or its cells have another size than the map's.
  bool add(const MapTile& tile);
  void clear();

  [[nodiscard]] bool is_empty() const { return ground_.is_empty(); }
  /// Edge of a planning cell, metres.
  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  [[nodiscard]] const Raster<Ground>& ground() const { return ground_; }
  [[nodiscard]] Ground ground_at(const Cell& cell) const {
    return ground_.contains(cell) ? ground_.at(cell) : Ground::kUnknown;
  }
  /// Whether the robot's centre can be here.
  [[nodiscard]] bool is_passable(const Cell& cell) const {
    return passable_.contains(cell) && passable_.at(cell) != 0;
  }
  [[nodiscard]] Cell cell_of(const Eigen::Vector2d& p_map) const {
    return (p_map / cell_size_m_).array().floor().cast<int>();
  }
  [[nodiscard]] Eigen::Vector2d center_of(const Cell& cell) const {
    return cell_size_m_ * (cell.cast<double>() + Eigen::Vector2d(0.5, 0.5));
  }
  /// Number of free planning cells.
  [[nodiscard]] std::int64_t num_free() const { return num_free_; }

 private:
  [[nodiscard]] bool make_room(const MapTile& tile);
  void find_near_offsets();
  [[nodiscard]] bool set(const Cell& map_cell, Ground now);
  void add_near(const Cell& map_cell, int change);
  void update_planning_cells(const Cell& low, const Cell& high);
  void update_planning_cell(const Cell& cell);
  [[nodiscard]] Ground raw_ground(const Cell& cell) const;
  [[nodiscard]] Ground filled_ground(const Cell& cell) const;
  [[nodiscard]] std::pair<Ground, int> next_known(const Cell& cell, const Cell& direction) const;
  [[nodiscard]] bool has_room(const Cell& cell) const;

  double inflation_radius_m_;
  double cell_size_m_ = 1.0;        // arbitrary before the first tile
  std::vector<Cell> near_offsets_;  // map cells within the inflation radius
  int reach_cells_ = 0;             // greatest offset along an axis
  Raster<Ground> map_;              // the map's own cells
  Raster<std::uint16_t>
      num_near_;        // for each map cell, number of occupied ones within the inflation radius
  Raster<Ground> raw_;  // planning cells before gaps are filled
  Raster<Ground> ground_;
  Raster<std::uint8_t> passable_;
  std::int64_t num_free_ = 0;
};

}  // namespace nodmap::explorer
