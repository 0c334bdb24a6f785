// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end/keyframe.hpp"
#include "modules/slam2d/back_end/submap_chain.hpp"
#include "modules/slam2d/cleared_region.hpp"
#include "modules/slam2d/grid/occupancy_grid.hpp"

namespace nodmap::slam2d {

/// For each point of a keyframe, how far its ray is believed to be free, in metres. A ray that is
/// much longer than the morphological opening of the lengths (over three neighbouring rays) looks
/// through a gap, or its range is wrong: it is believed only as far as the opening. Any other ray
/// is believed over its whole length.
[[nodiscard]] std::vector<double> believed_lengths(const Keyframe& keyframe);

/// Draws the rays of a keyframe at the pose `T_map_base`. A ray that is believed over its whole
/// length is drawn with the hit at its end, any other only as free space as far as it is believed.
/// The cells `left_out` are not changed. Returns the number of rays that the grid cannot hold.
std::int64_t draw(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid,
                  std::span<const CellRange> left_out = {});

/// Reverses draw() from the same pose with the same cells left out.
void erase(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid,
           std::span<const CellRange> left_out = {});

/// The occupancy grid of the map: drawn from the keyframes, and again from those that have moved.
class KeyframeGrid {
 public:
  explicit KeyframeGrid(double cell_size_m) : grid_(cell_size_m) {}

  /// A copy at little cost: see OccupancyGrid::snapshot().
  [[nodiscard]] KeyframeGrid snapshot();

  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }

  /// How many rays are missing because the grid cannot hold them; those of a keyframe that was
  /// drawn again count again.
  [[nodiscard]] std::int64_t rays_beyond() const { return rays_beyond_; }

  /// Draws the keyframes that were added since the last call.
  void draw_new(std::span<const Keyframe> keyframes);

  /// Redraws keyframes that the back end has moved by more than a cell. Checks at most
  /// `max_checked` of them in each call, in turn, and redraws at most `max_drawn`.
  void redraw_moved(std::span<const Keyframe> keyframes, std::size_t max_checked,
                    std::size_t max_drawn);
  /// Redraws all keyframes that the back end has moved by more than half a cell.
  void redraw_all_moved(std::span<const Keyframe> keyframes);

  /// Erases keyframes that the back end has dropped; objects that only they saw vanish with them.
  void drop(const DroppedKeyframes& dropped);

  /// How many cleared regions are kept: each keyframe that is drawn checks them for each cell.
  static constexpr std::size_t kMaxCleared = 100;
  /// Makes the cells of a region unknown; only later keyframes draw there. The region stays in
  /// place when loops move keyframes, and replaces those that lie inside it. Returns false, and
  /// changes nothing, if it would be one more than kMaxCleared.
  [[nodiscard]] bool clear(const Region& region);

  /// The cleared regions in which some keyframes are not drawn.
  [[nodiscard]] const std::vector<ClearedRegion>& cleared() const { return cleared_; }
  /// Restores the cleared regions of a saved map; must be called before its keyframes are drawn.
  void restore_cleared(std::vector<ClearedRegion> cleared) { cleared_ = std::move(cleared); }

 private:
  explicit KeyframeGrid(OccupancyGrid grid) : grid_(std::move(grid)) {}

  /// The cells in which a keyframe is not drawn.
  [[nodiscard]] std::vector<CellRange> left_out(std::size_t keyframe) const;
  void redraw(std::span<const Keyframe> keyframes, std::size_t keyframe);

  OccupancyGrid grid_;
  std::vector<geometry::SE2> drawn_at_;  // T_map_base of each keyframe in the grid
  std::size_t next_redrawn_ = 0;
  std::int64_t rays_beyond_ = 0;
  std::vector<ClearedRegion> cleared_;
};

}  // namespace nodmap::slam2d
