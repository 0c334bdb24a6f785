// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "common/geometry/map_tile.hpp"
#include "modules/navigator/planner/plan_window.hpp"

namespace nodmap::navigator {

/// The 2D map, which 2D SLAM draws or has read, on the cells of a plan: what the level scans have
/// shown, anywhere and at any time. Only the global planner reads it, where the local map has not
/// shown the ground: the level scans see neither low things nor holes, and the map may be old.
class Map2d {
 public:
  /// In this order: the greatest of several cells counts.
  enum class Kind : std::uint8_t { kUnknown, kFree, kOccupied };

  /// Replaces what the tile covers; a cell at its border keeps what its neighbours give of it.
  /// Returns false and changes nothing if its cells are too small, too large or too many, or if the
  /// map would become larger than 4096 x 4096 cells of a plan.
  bool add(const geometry::MapTile& tile);
  void clear();

  [[nodiscard]] bool is_empty() const { return blocks_.empty(); }

  /// Reads the cells from `first` on along x. Indices are counted from the origin of map.
  void read_row(const Eigen::Vector2i& first, std::span<Kind> row) const;

  /// The first and the last row and column that have ever been known.
  struct Extent {
    Eigen::Vector2i first;
    Eigen::Vector2i last;
  };
  [[nodiscard]] const std::optional<Extent>& extent() const { return extent_; }

  /// The map is stored in squares of so many cells a side.
  static constexpr int kBlockCells = 128;

 private:
  // What a tile gives of a cell: at the tile's border not all of its quarters.
  struct Part {
    Kind kind;
    std::uint8_t quarters;  // a mask of two bits for each
  };
  // The kind in each quarter of each cell. At the border of tiles the quarters of a cell come from
  // different tiles, and each tile replaces only its own.
  using Block = std::array<std::uint8_t, std::size_t{kBlockCells} * kBlockCells>;
  using BlockIndex = std::pair<int, int>;  // row, column

  [[nodiscard]] bool has_room(const Eigen::Vector2i& first, const Eigen::Vector2i& last) const;
  void write_row(const Eigen::Vector2i& first, std::span<const Part> row);

  std::map<BlockIndex, Block> blocks_;
  std::optional<Extent> extent_;
};

}  // namespace nodmap::navigator
