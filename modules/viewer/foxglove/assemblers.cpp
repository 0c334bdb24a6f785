// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/assemblers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/node/messages.hpp"

namespace nodmap::foxglove {
namespace {

bool is_whole(const nodmap::grid_chunk_t& tile) {
  const auto cells = std::int64_t{tile.grid_width} * tile.grid_height;
  return tile.grid_width > 0 && tile.grid_height > 0 && cells <= GridAssembler::kMaxCells &&
         tile.num_chunks > 0 && tile.num_chunks <= cells && tile.chunk_index >= 0 &&
         tile.chunk_index < tile.num_chunks && tile.tile_x >= 0 && tile.tile_y >= 0 &&
         tile.tile_width > 0 && tile.tile_height > 0 &&
         std::int64_t{tile.tile_x} + tile.tile_width <= tile.grid_width &&
         std::int64_t{tile.tile_y} + tile.tile_height <= tile.grid_height &&
         std::int64_t{tile.tile_width} * tile.tile_height == tile.num_cells &&
         tile.cell_size_m > 0.0 && std::isfinite(tile.cell_size_m) &&
         std::isfinite(tile.origin_x_m) && std::isfinite(tile.origin_y_m);
}

bool is_part(std::int32_t index, std::int32_t count, std::int32_t max_count) {
  return count > 0 && count <= max_count && index >= 0 && index < count;
}

}  // namespace

void GridAssembler::begin_revision(const nodmap::grid_chunk_t& tile) {
  if (tile.cell_size_m != grid_.cell_size_m) {
    grid_ = {};
  }
  revision_ = tile.map_revision;
  missing_ = tile.num_chunks;
  seen_.assign(static_cast<std::size_t>(tile.num_chunks), false);
  resize_grid(tile);
}

// Changes the extent of the grid to that given in the tile; keeps the cells that both extents
// contain.
void GridAssembler::resize_grid(const nodmap::grid_chunk_t& tile) {
  GridView old = std::exchange(grid_, {.stamp = time::from_utime(tile.utime),
                                       .cell_size_m = tile.cell_size_m,
                                       .origin_x_m = tile.origin_x_m,
                                       .origin_y_m = tile.origin_y_m,
                                       .width = tile.grid_width,
                                       .height = tile.grid_height,
                                       .cells = {}});
  if (old.width == grid_.width && old.height == grid_.height &&
      old.origin_x_m == grid_.origin_x_m && old.origin_y_m == grid_.origin_y_m) {
    grid_.cells = std::move(old.cells);
    return;
  }
  grid_.cells.assign(static_cast<std::size_t>(grid_.width) * static_cast<std::size_t>(grid_.height),
                     -1);
  const double shift_x = std::round((old.origin_x_m - grid_.origin_x_m) / grid_.cell_size_m);
  const double shift_y = std::round((old.origin_y_m - grid_.origin_y_m) / grid_.cell_size_m);
  if (!(std::abs(shift_x) < kMaxCells && std::abs(shift_y) < kMaxCells)) {
    return;
  }
  const auto dx = static_cast<std::int64_t>(shift_x);
  const auto dy = static_cast<std::int64_t>(shift_y);
  const std::int64_t begin_x = std::max<std::int64_t>(0, dx);
  const std::int64_t end_x = std::min<std::int64_t>(grid_.width, dx + old.width);
  const std::int64_t end_y = std::min<std::int64_t>(grid_.height, dy + old.height);
  for (std::int64_t y = std::max<std::int64_t>(0, dy); y < end_y && begin_x < end_x; ++y) {
    std::copy_n(old.cells.begin() + (y - dy) * old.width + begin_x - dx, end_x - begin_x,
                grid_.cells.begin() + y * grid_.width + begin_x);
  }
}

Assembled<GridView> GridAssembler::add(const nodmap::grid_chunk_t& tile) {
  Assembled<GridView> result;
  if (!is_whole(tile)) {
    result.refused = true;
    return result;
  }
  const auto map = newest_.classify(tile.map_revision);
  if (map == node::MapRevision::Tile::kLate) {
    result.refused = true;
    return result;
  }
  if (map == node::MapRevision::Tile::kOfNewMap) {
    grid_ = {};
  }
  if (tile.map_revision != revision_) {
    result.lost = missing_ > 0;
    begin_revision(tile);
  }
  const auto index = static_cast<std::size_t>(tile.chunk_index);
  if (tile.grid_width != grid_.width || tile.grid_height != grid_.height || index >= seen_.size() ||
      seen_[index]) {
    result.refused = true;
    return result;
  }
  for (std::int32_t row = 0; row < tile.tile_height; ++row) {
    const auto from = tile.cells.begin() + std::ptrdiff_t{row} * tile.tile_width;
    std::copy(
        from, from + tile.tile_width,
        grid_.cells.begin() + (std::ptrdiff_t{tile.tile_y} + row) * grid_.width + tile.tile_x);
  }
  seen_[index] = true;
  if (--missing_ == 0) {
    result.whole = grid_;
  }
  return result;
}

PartsInOrder::Place PartsInOrder::add(std::int64_t whole, std::int32_t index, std::int32_t count) {
  Place place;
  const bool continues = next_ > 0 && whole == whole_ && index == next_ && count == count_;
  if (!continues) {
    place.lost = next_ > 0 || index > 0;
    next_ = 0;
    if (index > 0) {
      return place;
    }
    whole_ = whole;
    count_ = count;
  }
  place.taken = true;
  place.is_first = next_ == 0;
  ++next_;
  place.is_last = next_ == count_;
  if (place.is_last) {
    next_ = 0;
  }
  return place;
}

Assembled<CloudView> CloudAssembler::add(const nodmap::cloud_chunk_t& chunk) {
  Assembled<CloudView> result;
  const auto pose = node::read_pose(chunk.position_m, chunk.orientation);
  if (!pose || !is_part(chunk.chunk_index, chunk.num_chunks, kMaxChunks)) {
    result.refused = true;
    return result;
  }
  const PartsInOrder::Place place =
      parts_.add(chunk.keyframe_id, chunk.chunk_index, chunk.num_chunks);
  result.lost = place.lost;
  if (!place.taken) {
    return result;
  }
  if (place.is_first) {
    cloud_ = {time::from_utime(chunk.utime), frames::kMap6d, *pose, {}};
  }
  if (cloud_.xyz_m.size() / 3 + chunk.points_m.size() > kMaxPoints) {
    *this = CloudAssembler();
    result.refused = true;
    return result;
  }
  for (const std::vector<float>& p : chunk.points_m) {
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) {
      cloud_.xyz_m.insert(cloud_.xyz_m.end(), p.begin(), p.end());
    }
  }
  if (place.is_last) {
    result.whole = std::move(cloud_);
  }
  return result;
}

Assembled<OctomapView> OctomapAssembler::add(const nodmap::octomap_chunk_t& chunk) {
  Assembled<OctomapView> result;
  if (!is_part(chunk.chunk_index, chunk.num_chunks, kMaxChunks)) {
    result.refused = true;
    return result;
  }
  const PartsInOrder::Place place =
      parts_.add(chunk.map_revision, chunk.chunk_index, chunk.num_chunks);
  result.lost = place.lost;
  if (!place.taken) {
    return result;
  }
  if (place.is_first) {
    file_.clear();
  }
  file_.append(chunk.bytes.begin(), chunk.bytes.end());
  if (place.is_last) {
    auto space = formats::read_octomap(std::exchange(file_, {}));
    result.refused = !space;
    if (space) {
      result.whole = OctomapView{time::from_utime(chunk.utime), std::move(*space)};
    }
  }
  return result;
}

}  // namespace nodmap::foxglove
