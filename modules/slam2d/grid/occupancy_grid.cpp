// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr std::int64_t kMaxCells = 64'000'000;  // 400 m x 400 m at 5 cm
constexpr double kMaxCoordinateCells = 1'000'000'000.0;

bool is_drawable(const Eigen::Vector2d& cells) {
  return cells.allFinite() && cells.cwiseAbs().maxCoeff() < kMaxCoordinateCells;
}

// At least this many tiles are chosen if there are any, so that a small map is soon complete.
constexpr std::size_t kMinChosenTiles = 4;

constexpr int kTileCells = OccupancyGrid::kTileCells;
constexpr std::size_t kCellsPerTile = std::size_t{kTileCells} * kTileCells;
constexpr std::uint32_t kOneLess = std::numeric_limits<std::uint32_t>::max();  // modulo 2^32

// A shift rounds down for negative indices, too.
Eigen::Vector2i tile_of(const Eigen::Vector2i& cell) {
  static_assert(kTileCells == 1 << 7);
  return {cell.x() >> 7, cell.y() >> 7};
}

std::size_t place_in_tile(const Eigen::Vector2i& cell) {
  return std::size_t{kTileCells} * static_cast<std::size_t>(cell.y()) +
         static_cast<std::size_t>(cell.x());
}

// The grid lines across each axis from a cell of a tile to the borders in a direction.
Eigen::Vector2i lines_to_border(const Eigen::Vector2i& cell, const Eigen::Vector2i& direction) {
  return {direction.x() > 0 ? kTileCells - cell.x() : cell.x() + 1,
          direction.y() > 0 ? kTileCells - cell.y() : cell.y() + 1};
}

bool is_counted(const Eigen::Vector2i& cell, std::span<const CellRange> left_out) {
  return std::none_of(left_out.begin(), left_out.end(),
                      [&](const CellRange& range) { return range.has(cell); });
}

// Whether the cells are the same in a map of free, occupied and unknown cells.
bool looks_alike(const std::vector<std::int8_t>& a, const std::vector<std::int8_t>& b) {
  if (a.size() != b.size()) {
    return false;
  }
  // Branch-free over all cells, so that the compiler vectorises it.
  const auto state = [](std::int8_t cell) {
    return static_cast<std::int8_t>((cell < 0 ? 1 : 0) |
                                    (OccupancyGrid::is_occupied(cell) ? 2 : 0));
  };
  std::int8_t difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<std::int8_t>(difference | (state(a[i]) ^ state(b[i])));
  }
  return difference == 0;
}

}  // namespace

OccupancyGrid OccupancyGrid::snapshot() {
  for (Tile& tile : tiles_) {
    tile.is_shared = true;
  }
  return *this;
}

// Must be called before the counts of a tile change.
void OccupancyGrid::make_own(Tile& tile) {
  if (tile.is_shared) {
    tile.counts = std::make_shared<Counts>(*tile.counts);
    tile.is_shared = false;
  }
}

bool OccupancyGrid::add_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                            std::span<const CellRange> left_out) {
  return count_ray(sensor_origin, end, {1, 1}, left_out);
}

void OccupancyGrid::remove_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                               std::span<const CellRange> left_out) {
  count_ray(sensor_origin, end, {kOneLess, kOneLess}, left_out);
}

bool OccupancyGrid::add_free_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                                 std::span<const CellRange> left_out) {
  return count_ray(sensor_origin, end, {1, 0}, left_out);
}

void OccupancyGrid::remove_free_ray(const Eigen::Vector2d& sensor_origin,
                                    const Eigen::Vector2d& end,
                                    std::span<const CellRange> left_out) {
  count_ray(sensor_origin, end, {kOneLess, 0}, left_out);
}

bool OccupancyGrid::add_cell(const Eigen::Vector2d& p_map, bool is_occupied) {
  const Eigen::Vector2d cells = p_map / cell_size_m_;
  if (!is_drawable(cells)) {
    return false;
  }
  const Eigen::Vector2i cell = cells.array().floor().cast<int>();
  if (!make_room(cell, cell)) {
    return false;
  }
  Tile& tile = enter_tile(cell);
  std::vector<std::uint32_t>& counts = is_occupied ? tile.counts->ended : tile.counts->passed;
  ++counts[place_in_tile(cell - kTileCells * tile.position)];
  return true;
}

bool OccupancyGrid::count_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                              const Counted& counted, std::span<const CellRange> left_out) {
  const Eigen::Vector2d from = sensor_origin / cell_size_m_;
  const Eigen::Vector2d to = end / cell_size_m_;
  if (!is_drawable(from) || !is_drawable(to)) {
    return false;
  }
  RayWalk ray(from, to);
  const Eigen::Vector2i first = ray.first_cell();
  const Eigen::Vector2i last = ray.last_cell();
  if (!make_room(first.cwiseMin(last), first.cwiseMax(last))) {
    return false;
  }
  Eigen::Vector2i cell = first;
  Tile* tile = &enter_tile(cell);
  // Tile by tile: within a tile each step consists of additions only.
  for (int left = (last - first).cwiseAbs().sum(); left > 0;) {
    const Eigen::Vector2i at = cell - kTileCells * tile->position;
    const Eigen::Vector2i crossed = ray.crossings_until(lines_to_border(at, ray.direction()));
    const int steps = std::min(left, crossed.sum());
    pass_through(*tile, at, ray, steps, counted.passed, left_out);
    left -= steps;
    if (steps == crossed.sum()) {
      cell += crossed.cwiseProduct(ray.direction());
      tile = &enter_tile(cell);
    }
  }
  if (is_counted(last, left_out)) {
    tile->counts->ended[place_in_tile(last - kTileCells * tile->position)] += counted.ended;
  }
  return true;
}

void OccupancyGrid::pass_through(Tile& tile, const Eigen::Vector2i& at, RayWalk& ray, int steps,
                                 std::uint32_t passed, std::span<const CellRange> left_out) {
  const auto place = static_cast<std::ptrdiff_t>(place_in_tile(at));
  std::uint32_t* const counts = tile.counts->passed.data();
  if (left_out.empty()) {  // the usual case
    ray.advance(steps, place, kTileCells, [&](std::size_t k) { counts[k] += passed; });
    return;
  }
  ray.advance(steps, place, kTileCells, [&](std::size_t k) {
    const auto index = static_cast<int>(k);
    const Eigen::Vector2i cell(index % kTileCells, index / kTileCells);
    counts[k] += is_counted(cell + kTileCells * tile.position, left_out) ? passed : 0;
  });
}

CellRange OccupancyGrid::cells_of(const Region& region) const {
  const auto cells = [this](const Eigen::Vector2d& p) {
    return (p / cell_size_m_).array().max(-kMaxCoordinateCells).min(kMaxCoordinateCells).eval();
  };
  return {cells(region.low).floor().cast<int>().matrix(),
          cells(region.high).ceil().cast<int>().matrix() - Eigen::Vector2i::Ones()};
}

void OccupancyGrid::clear(const CellRange& cells) {
  for (Tile& tile : tiles_) {
    const Eigen::Vector2i first = kTileCells * tile.position;
    const Eigen::Vector2i low = (cells.low - first).cwiseMax(0);
    const Eigen::Vector2i high = (cells.high - first).cwiseMin(kTileCells - 1);
    if ((low.array() > high.array()).any()) {
      continue;
    }
    make_own(tile);
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const std::size_t place = place_in_tile({x, y});
        tile.counts->passed[place] = 0;
        tile.counts->ended[place] = 0;
      }
    }
    ++tile.num_changes;
  }
}

std::int32_t& OccupancyGrid::tile_at(const Eigen::Vector2i& position) {
  const Eigen::Vector2i offset = position - first_tile_;
  return tile_numbers_[static_cast<std::size_t>(offset.y()) *
                           static_cast<std::size_t>(size_tiles_.x()) +
                       static_cast<std::size_t>(offset.x())];
}

OccupancyGrid::Tile& OccupancyGrid::enter_tile(const Eigen::Vector2i& cell) {
  const Eigen::Vector2i position = tile_of(cell);
  std::int32_t& number = tile_at(position);
  if (number == kNoTile) {
    number = static_cast<std::int32_t>(tiles_.size());
    tiles_.push_back(
        {.position = position,
         .counts = std::make_shared<Counts>(Counts{std::vector<std::uint32_t>(kCellsPerTile),
                                                   std::vector<std::uint32_t>(kCellsPerTile)})});
  }
  Tile& tile = tiles_[static_cast<std::size_t>(number)];
  make_own(tile);
  ++tile.num_changes;
  return tile;
}

bool OccupancyGrid::make_room(const Eigen::Vector2i& low, const Eigen::Vector2i& high) {
  const bool is_empty = tiles_.empty();
  const Eigen::Vector2i low_tile = tile_of(low);
  const Eigen::Vector2i end_tile = tile_of(high) + Eigen::Vector2i::Ones();
  const Eigen::Vector2i end = first_tile_ + size_tiles_;
  if (!is_empty && (low_tile.array() >= first_tile_.array()).all() &&
      (end_tile.array() <= end.array()).all()) {
    return true;
  }
  const Eigen::Vector2i new_first = is_empty ? low_tile : low_tile.cwiseMin(first_tile_);
  const Eigen::Vector2i new_end = is_empty ? end_tile : end_tile.cwiseMax(end);
  const Eigen::Vector2i size = new_end - new_first;
  if (static_cast<std::int64_t>(size.x()) * size.y() >
      kMaxCells / static_cast<std::int64_t>(kCellsPerTile)) {
    return false;
  }
  first_tile_ = new_first;
  size_tiles_ = size;
  tile_numbers_.assign(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()),
                       kNoTile);
  for (std::size_t number = 0; number < tiles_.size(); ++number) {
    tile_at(tiles_[number].position) = static_cast<std::int32_t>(number);
  }
  return true;
}

std::int8_t OccupancyGrid::occupancy(const Tile& tile, std::size_t cell) {
  const std::uint64_t ended = tile.counts->ended[cell];
  const std::uint64_t rays = ended + tile.counts->passed[cell];
  if (ended == 0) {  // the usual case, without a division
    return rays == 0 ? kUnknown : std::int8_t{0};
  }
  return static_cast<std::int8_t>((200 * ended + rays) / (2 * rays));
}

std::int8_t OccupancyGrid::occupancy(int x, int y) const {
  const std::int32_t number = tile_numbers_[static_cast<std::size_t>(y / kTileCells) *
                                                static_cast<std::size_t>(size_tiles_.x()) +
                                            static_cast<std::size_t>(x / kTileCells)];
  return number == kNoTile ? kUnknown
                           : occupancy(tiles_[static_cast<std::size_t>(number)],
                                       place_in_tile({x % kTileCells, y % kTileCells}));
}

// Most cells are free or unknown, which needs no division and is computed for many cells at once.
// Only the others need a division.
GridTile OccupancyGrid::cut_tile(std::size_t number) const {
  constexpr std::size_t kAtOnce = 16;
  static_assert(kCellsPerTile % kAtOnce == 0);
  const Tile& tile = tiles_[number];
  const Counts& counts = *tile.counts;
  const Eigen::Vector2i first = first_cell(number);
  GridTile cut{.number = number, .x = first.x(), .y = first.y(), .cells = {}};
  cut.cells.resize(kCellsPerTile);
  std::transform(counts.passed.begin(), counts.passed.end(), cut.cells.begin(),
                 [](std::uint32_t passed) { return passed == 0 ? kUnknown : std::int8_t{0}; });
  for (std::size_t begin = 0; begin < kCellsPerTile; begin += kAtOnce) {
    std::uint32_t any_ended = 0;
    for (std::size_t i = begin; i < begin + kAtOnce; ++i) {
      any_ended |= counts.ended[i];
    }
    for (std::size_t i = begin; any_ended != 0 && i < begin + kAtOnce; ++i) {
      if (counts.ended[i] != 0) {
        cut.cells[i] = occupancy(tile, i);
      }
    }
  }
  return cut;
}

void TileSelector::choose_tile(const OccupancyGrid& grid, GridTile tile,
                               std::vector<GridTile>& chosen) {
  Sent& sent = sent_[tile.number];
  sent.num_changes = grid.num_changes(tile.number);
  sent.cells = tile.cells;
  chosen.push_back(std::move(tile));
}

GridTile TileSelector::tile_now(const OccupancyGrid& grid, std::size_t number) const {
  const Sent& sent = sent_[number];
  if (sent.cells.empty() || sent.num_changes != grid.num_changes(number)) {
    return grid.cut_tile(number);
  }
  const Eigen::Vector2i first = grid.first_cell(number);
  return {.number = number, .x = first.x(), .y = first.y(), .cells = sent.cells};
}

std::vector<GridTile> TileSelector::choose(const OccupancyGrid& grid) {
  sent_.resize(grid.num_tiles());
  std::vector<GridTile> chosen;
  for (std::size_t number = 0; number < sent_.size(); ++number) {
    Sent& sent = sent_[number];
    if (sent.num_changes_seen == grid.num_changes(number)) {
      continue;
    }
    sent.num_changes_seen = grid.num_changes(number);
    GridTile tile = grid.cut_tile(number);
    if (!looks_alike(tile.cells, sent.cells)) {
      choose_tile(grid, std::move(tile), chosen);
    }
  }
  add_others_in_turn(grid, chosen);
  return chosen;
}

void TileSelector::add_others_in_turn(const OccupancyGrid& grid, std::vector<GridTile>& chosen) {
  const std::size_t changed = chosen.size();
  const std::size_t others =
      std::max<std::size_t>(1, kMinChosenTiles - std::min(kMinChosenTiles, changed));
  const auto is_chosen = [&](std::size_t number) {
    return std::any_of(chosen.begin(), chosen.end(),
                       [number](const GridTile& tile) { return tile.number == number; });
  };
  for (std::size_t i = 0; i < sent_.size() && chosen.size() < changed + others; ++i) {
    next_repeated_ = (next_repeated_ + 1) % sent_.size();
    if (!is_chosen(next_repeated_)) {
      choose_tile(grid, tile_now(grid, next_repeated_), chosen);
    }
  }
}

std::vector<GridTile> TileSelector::choose_rest(const OccupancyGrid& grid) {
  sent_.resize(grid.num_tiles());
  std::vector<GridTile> chosen;
  for (std::size_t number = 0; number < sent_.size(); ++number) {
    GridTile tile = grid.cut_tile(number);
    if (tile.cells != sent_[number].cells) {
      choose_tile(grid, std::move(tile), chosen);
    }
  }
  return chosen;
}

}  // namespace nodmap::slam2d
