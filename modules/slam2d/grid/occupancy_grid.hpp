// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "modules/slam2d/cleared_region.hpp"
#include "modules/slam2d/grid/ray_walk.hpp"

namespace nodmap::slam2d {

/// A square of kTileCells x kTileCells cells.
struct GridTile {
  std::size_t number = 0;
  int x = 0;  ///< its first cell in the grid
  int y = 0;
  std::vector<std::int8_t> cells;  ///< occupancy row by row, x fastest
};

/// A rectangle of cells, counted from the map's origin; both corners are part of it.
struct CellRange {
  Eigen::Vector2i low = Eigen::Vector2i::Zero();
  Eigen::Vector2i high = Eigen::Vector2i::Zero();

  [[nodiscard]] bool has(const Eigen::Vector2i& cell) const {
    return (cell.array() >= low.array()).all() && (cell.array() <= high.array()).all();
  }
};

/// A 2D grid in the map frame. Counts, for each cell, the rays that ended in it and those that
/// passed through. It grows tile by tile to hold whatever is drawn, so its memory follows the area
/// that was seen, not the rectangle around it. A grid can be as large as 500 MB: it is copied only
/// by snapshot().
class OccupancyGrid {
 public:
  static constexpr std::int8_t kUnknown = -1;
  /// Edge of a tile in cells. The message of a tile stays far below 64 KiB.
  static constexpr int kTileCells = 128;

  explicit OccupancyGrid(double cell_size_m) : cell_size_m_(cell_size_m) {}
  OccupancyGrid(OccupancyGrid&&) = default;
  OccupancyGrid& operator=(OccupancyGrid&&) = default;
  OccupancyGrid& operator=(const OccupancyGrid&) = delete;
  ~OccupancyGrid() = default;

  /// A copy at little cost: it shares the counts of each tile until one of the two changes them.
  /// The copy may be used, changed and destroyed on another thread.
  [[nodiscard]] OccupancyGrid snapshot();

  /// Draws a ray from the scanner to the point it hit, both in map, metres. Returns false, and
  /// draws nothing, for a ray that is not finite or needs a grid of more than 64 million cells. The
  /// cells `left_out` are not changed.
  bool add_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
               std::span<const CellRange> left_out = {});

  /// Removes a ray that add_ray() has drawn.
  void remove_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                  std::span<const CellRange> left_out = {});

  /// As add_ray(), but only the free space: without a hit at the end.
  bool add_free_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                    std::span<const CellRange> left_out = {});

  /// Removes a ray that add_free_ray() has drawn.
  void remove_free_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                       std::span<const CellRange> left_out = {});

  /// Counts one ray in the cell at `p_map`: one that ended there, or one that passed through.
  /// Returns false, and counts nothing, as add_ray() does.
  bool add_cell(const Eigen::Vector2d& p_map, bool is_occupied);

  /// The cells that a region touches. Cells beyond any possible grid are moved to its limits.
  [[nodiscard]] CellRange cells_of(const Region& region) const;
  /// Forgets all rays in these cells.
  void clear(const CellRange& cells);

  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  [[nodiscard]] int width() const { return kTileCells * size_tiles_.x(); }
  [[nodiscard]] int height() const { return kTileCells * size_tiles_.y(); }
  /// Outer corner of cell (0, 0) in map, metres.
  [[nodiscard]] Eigen::Vector2d origin() const {
    return cell_size_m_ * kTileCells * first_tile_.cast<double>();
  }
  /// Per cent of the cell's rays that ended in it, or kUnknown where there were none.
  [[nodiscard]] std::int8_t occupancy(int x, int y) const;
  /// Whether at least a quarter of the rays ended here. Not more, because many rays only graze the
  /// cell of a wall.
  [[nodiscard]] bool is_occupied(int x, int y) const { return is_occupied(occupancy(x, y)); }
  [[nodiscard]] static bool is_occupied(std::int8_t occupancy) { return occupancy >= 25; }

  /// Number of tiles that a ray has entered. Tiles are numbered in the order in which that
  /// happened.
  [[nodiscard]] std::size_t num_tiles() const { return tiles_.size(); }
  /// Counts the rays that entered a tile, and how often it was cleared. While this number stays the
  /// same, so does the tile.
  [[nodiscard]] std::uint64_t num_changes(std::size_t tile) const {
    return tiles_[tile].num_changes;
  }
  [[nodiscard]] GridTile cut_tile(std::size_t number) const;
  /// The first cell of a tile in the grid.
  [[nodiscard]] Eigen::Vector2i first_cell(std::size_t tile) const {
    return kTileCells * (tiles_[tile].position - first_tile_);
  }

 private:
  OccupancyGrid(const OccupancyGrid&) = default;  // for snapshot()

  struct Counts {
    std::vector<std::uint32_t> passed;  ///< rays through each cell, row by row, x fastest
    std::vector<std::uint32_t> ended;   ///< and those that ended in it
  };
  struct Tile {
    Eigen::Vector2i position;  ///< in tiles from the map's origin
    std::shared_ptr<Counts> counts;
    /// Since a snapshot: the counts are copied before they change. Not the number of owners, which
    /// another thread may be reducing.
    bool is_shared = false;
    std::uint64_t num_changes = 0;
  };
  static constexpr std::int32_t kNoTile = -1;

  /// What a ray adds to the counts: `passed` in each cell that it enters, `ended` in its last.
  struct Counted {
    std::uint32_t passed = 0;
    std::uint32_t ended = 0;
  };
  bool count_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                 const Counted& counted, std::span<const CellRange> left_out);
  /// Counts the next `steps` cells of a ray that comes to the cell `at` of a tile.
  static void pass_through(Tile& tile, const Eigen::Vector2i& at, RayWalk& ray, int steps,
                           std::uint32_t passed, std::span<const CellRange> left_out);
  [[nodiscard]] bool make_room(const Eigen::Vector2i& low, const Eigen::Vector2i& high);
  /// The number of the tile at a position within the grid, or kNoTile.
  [[nodiscard]] std::int32_t& tile_at(const Eigen::Vector2i& position);
  [[nodiscard]] Tile& enter_tile(const Eigen::Vector2i& cell);
  static void make_own(Tile& tile);
  [[nodiscard]] static std::int8_t occupancy(const Tile& tile, std::size_t cell);

  double cell_size_m_;
  Eigen::Vector2i first_tile_ = Eigen::Vector2i::Zero();  ///< from the map's origin
  Eigen::Vector2i size_tiles_ = Eigen::Vector2i::Zero();
  std::vector<std::int32_t> tile_numbers_;  ///< by position, row by row, x fastest
  std::vector<Tile> tiles_;
};

/// Chooses the tiles of a grid that are to be published: those that have changed, and a few others
/// in turn, so that a receiver that started late or lost a tile has the whole grid after a while.
/// The cost depends on what has changed, not on the size of the grid.
class TileSelector {
 public:
  /// The tiles in which a cell became known, unknown, free or occupied since they were last chosen,
  /// and at least one other tile in turn.
  [[nodiscard]] std::vector<GridTile> choose(const OccupancyGrid& grid);

  /// All tiles that differ from what was last chosen.
  [[nodiscard]] std::vector<GridTile> choose_rest(const OccupancyGrid& grid);

 private:
  struct Sent {
    std::uint64_t num_changes_seen = 0;
    std::uint64_t num_changes = 0;   ///< when it was last chosen
    std::vector<std::int8_t> cells;  ///< as they were then
  };
  void choose_tile(const OccupancyGrid& grid, GridTile tile, std::vector<GridTile>& chosen);
  /// The tile as it is now; cut only if it has changed since it was last chosen.
  [[nodiscard]] GridTile tile_now(const OccupancyGrid& grid, std::size_t number) const;
  void add_others_in_turn(const OccupancyGrid& grid, std::vector<GridTile>& chosen);

  std::vector<Sent> sent_;  ///< of each tile
  std::size_t next_repeated_ = 0;
};

}  // namespace nodmap::slam2d
