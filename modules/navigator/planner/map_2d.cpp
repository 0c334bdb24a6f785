// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/map_2d.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nodmap::navigator {
namespace {

using geometry::MapTile;

// Maps with smaller or larger cells are not used: with larger ones no door would be open.
constexpr double kSmallestCellM = 0.01;
constexpr double kLargestCellM = 0.2;
// More than a tile of 2D SLAM has, even with the largest cells. A tile may claim any size, and no
// decision must wait until it has been added: this takes less than a millisecond.
constexpr double kMaxTileCells = 1 << 18;
// Of 128 x 128 cells: 16 MB.
constexpr std::size_t kMaxBlocks = 1024;
// A plan's cell that touches one of the map's cells by less than this part of it does not count.
constexpr double kTouch = 1e-6;

Map2d::Kind kind_of(std::int8_t occupancy) {
  if (occupancy < 0) {
    return Map2d::Kind::kUnknown;
  }
  return occupancy >= MapTile::kOccupiedPercent ? Map2d::Kind::kOccupied : Map2d::Kind::kFree;
}

// The cells along one axis, from `first` to `last`.
struct Line {
  int first;
  int last;
  [[nodiscard]] int size() const { return last - first + 1; }
};

// The cells of the plan that `count` cells of the map overlap. `ratio`: map cell by plan cell.
Line overlapping(int first, int count, double ratio) {
  return {static_cast<int>(std::floor(ratio * first + kTouch)),
          static_cast<int>(std::ceil(ratio * (first + count) - kTouch)) - 1};
}

// A cell of the plan at the border of tiles is partly in each of them: a quarter has two bits in
// the cell's byte. Which quarters a tile gives, along one axis:
struct Halves {
  std::uint8_t low;
  std::uint8_t high;
};
constexpr Halves kColumns{0b00'11'00'11, 0b11'00'11'00};
constexpr Halves kRows{0b00'00'11'11, 0b11'11'00'00};

// The halves of a cell of the plan that `count` cells of the map give: the high one if they begin
// inside it, the low one if they end inside it, otherwise both.
std::uint8_t given(const Halves& halves, int index, int first, int count, double ratio) {
  const bool begins_inside = ratio * first > index + kTouch;
  const bool ends_inside = ratio * (first + count) < index + 1 - kTouch;
  if (begins_inside == ends_inside) {
    return halves.low | halves.high;
  }
  return begins_inside ? halves.high : halves.low;
}

// The same kind in all quarters, and the greatest of them.
std::uint8_t in_all_quarters(Map2d::Kind kind) {
  return static_cast<std::uint8_t>(0b01'01'01'01 * static_cast<unsigned>(kind));
}

Map2d::Kind greatest_quarter(std::uint8_t quarters) {
  if ((quarters & in_all_quarters(Map2d::Kind::kOccupied)) != 0) {
    return Map2d::Kind::kOccupied;
  }
  return quarters == 0 ? Map2d::Kind::kUnknown : Map2d::Kind::kFree;
}

// The cells of the tile that a cell of the plan overlaps, from 0 on.
Line overlapped(int index, int first, int count, double ratio) {
  const auto low = static_cast<int>(std::floor(index / ratio + kTouch)) - first;
  const auto high = static_cast<int>(std::ceil((index + 1) / ratio - kTouch)) - 1 - first;
  return {std::clamp(low, 0, count - 1), std::clamp(high, 0, count - 1)};
}

Map2d::Kind greatest(const MapTile& tile, const Line& columns, const Line& rows) {
  auto greatest = Map2d::Kind::kUnknown;
  for (int row = rows.first; row <= rows.last; ++row) {
    for (int column = columns.first; column <= columns.last; ++column) {
      const std::size_t index =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(tile.width) +
          static_cast<std::size_t>(column);
      greatest = std::max(greatest, kind_of(tile.cells[index]));
    }
  }
  return greatest;
}

// The block of a cell along one axis.
int block_of(int index) {
  return index >= 0 ? index / Map2d::kBlockCells
                    : -((Map2d::kBlockCells - 1 - index) / Map2d::kBlockCells);
}

// Calls `visit(column, count, block column, index in the block)` for each piece of a row that lies
// in one block. `column`: from the row's beginning; the index: of its first cell.
void for_each_piece(const Eigen::Vector2i& first, int size, const auto& visit) {
  const int row_in_block = first.y() - Map2d::kBlockCells * block_of(first.y());
  for (int column = 0; column < size;) {
    const int x = first.x() + column;
    const int block = block_of(x);
    const int in_block = x - Map2d::kBlockCells * block;
    const int count = std::min(size - column, Map2d::kBlockCells - in_block);
    visit(column, count, block, Map2d::kBlockCells * row_in_block + in_block);
    column += count;
  }
}

}  // namespace

void Map2d::clear() {
  *this = Map2d();
}

bool Map2d::add(const MapTile& tile) {
  if (!(tile.cell_size_m >= kSmallestCellM && tile.cell_size_m <= kLargestCellM)) {
    return false;
  }
  const double ratio = tile.cell_size_m / PlanWindow::kCellM;
  const double num_cells = static_cast<double>(tile.width) * tile.height;
  if (num_cells * std::max(1.0, ratio * ratio) > kMaxTileCells) {
    return false;
  }
  const Line columns = overlapping(tile.first.x(), tile.width, ratio);
  const Line rows = overlapping(tile.first.y(), tile.height, ratio);
  if (!has_room({columns.first, rows.first}, {columns.last, rows.last})) {
    return false;
  }
  std::vector<Part> parts(static_cast<std::size_t>(columns.size()));
  for (int row = rows.first; row <= rows.last; ++row) {
    const Line tile_rows = overlapped(row, tile.first.y(), tile.height, ratio);
    const std::uint8_t half = given(kRows, row, tile.first.y(), tile.height, ratio);
    for (int column = columns.first; column <= columns.last; ++column) {
      parts[static_cast<std::size_t>(column - columns.first)] = {
          greatest(tile, overlapped(column, tile.first.x(), tile.width, ratio), tile_rows),
          static_cast<std::uint8_t>(half &
                                    given(kColumns, column, tile.first.x(), tile.width, ratio))};
    }
    write_row({columns.first, row}, parts);
  }
  return true;
}

bool Map2d::has_room(const Eigen::Vector2i& first, const Eigen::Vector2i& last) const {
  std::size_t num_blocks = blocks_.size();
  for (int row = block_of(first.y()); row <= block_of(last.y()); ++row) {
    for (int column = block_of(first.x()); column <= block_of(last.x()); ++column) {
      num_blocks += blocks_.contains({row, column}) ? 0 : 1;
    }
  }
  return num_blocks <= kMaxBlocks;
}

void Map2d::write_row(const Eigen::Vector2i& first, std::span<const Part> row) {
  for_each_piece(
      first, static_cast<int>(row.size()), [&](int column, int count, int block, int to) {
        auto* cell = blocks_[{block_of(first.y()), block}].begin() + to;
        for (const Part& part :
             row.subspan(static_cast<std::size_t>(column), static_cast<std::size_t>(count))) {
          *cell = static_cast<std::uint8_t>((*cell & ~part.quarters) |
                                            (in_all_quarters(part.kind) & part.quarters));
          ++cell;
        }
      });
  const auto is_known = [](const Part& part) { return part.kind != Kind::kUnknown; };
  const auto known = std::ranges::find_if(row, is_known);
  if (known == row.end()) {
    return;
  }
  const auto last = std::find_if(row.rbegin(), row.rend(), is_known);
  const Eigen::Vector2i low(first.x() + static_cast<int>(known - row.begin()), first.y());
  const Eigen::Vector2i high(first.x() + static_cast<int>(row.rend() - last) - 1, first.y());
  if (!extent_) {
    extent_ = {low, high};
  }
  extent_ = {extent_->first.cwiseMin(low), extent_->last.cwiseMax(high)};
}

void Map2d::read_row(const Eigen::Vector2i& first, std::span<Kind> row) const {
  for_each_piece(
      first, static_cast<int>(row.size()), [&](int column, int count, int block, int at) {
        const auto piece =
            row.subspan(static_cast<std::size_t>(column), static_cast<std::size_t>(count));
        const auto found = blocks_.find({block_of(first.y()), block});
        if (found == blocks_.end()) {
          std::ranges::fill(piece, Kind::kUnknown);
        } else {
          std::transform(found->second.begin() + at, found->second.begin() + at + count,
                         piece.begin(), greatest_quarter);
        }
      });
}

}  // namespace nodmap::navigator
