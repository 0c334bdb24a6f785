// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end.hpp"
#include "modules/slam2d/cleared_region.hpp"
#include "modules/slam2d/occupancy_grid.hpp"
#include "modules/slam2d/submap.hpp"

namespace nodmap::slam2d {

/// How far each ray of a keyframe is believed to be free, metres: what is narrower than three
/// neighbouring rays (the morphological opening of their lengths) is a look through a gap, or a
/// range that is wrong. One value for each point; the length of the ray where it is believed.
[[nodiscard]] std::vector<double> believed_lengths(const Keyframe& keyframe);

/// Draws the rays of a keyframe, seen from a pose in the map: whole where their lengths are
/// believed, otherwise only their free space as far as that is. Not in the cells `left_out`.
void draw(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid,
          std::span<const CellRange> left_out = {});

/// Takes back what draw() has drawn from the same pose, with the same cells left out.
void erase(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid,
           std::span<const CellRange> left_out = {});

/// The occupancy grid of the map: drawn from the keyframes, and again from those that have moved.
class KeyframeGrid {
 public:
  explicit KeyframeGrid(double cell_size_m) : grid_(cell_size_m) {}

  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }

  /// Draws the keyframes that came since the last call.
  void draw_new(std::span<const Keyframe> keyframes);

  /// Draws keyframes again that the back end has moved by more than a cell: looks at `max_checked`
  /// of them, in turn, and draws `max_drawn` at most.
  void redraw_moved(std::span<const Keyframe> keyframes, std::size_t max_checked,
                    std::size_t max_drawn);
  /// Draws all keyframes again that the back end has moved by more than half a cell.
  void redraw_all_moved(std::span<const Keyframe> keyframes);

  /// Takes keyframes back that the back end has dropped: what has vanished goes with them.
  void drop(const DroppedKeyframes& dropped);

  /// From now on nothing is known of the cells of a region but what later keyframes see there.
  /// The region stays where it is in map when loops move the keyframes.
  void clear(const Region& region);

  /// Regions that are cleared and still hide keyframes.
  [[nodiscard]] const std::vector<ClearedRegion>& cleared() const { return cleared_; }
  /// Takes over those of a saved map; to be called before its keyframes are drawn.
  void restore_cleared(std::vector<ClearedRegion> cleared) { cleared_ = std::move(cleared); }

 private:
  /// The cells in which a keyframe is not drawn.
  [[nodiscard]] std::vector<CellRange> left_out(std::size_t keyframe) const;
  void redraw(std::span<const Keyframe> keyframes, std::size_t keyframe);

  OccupancyGrid grid_;
  std::vector<geometry::SE2> drawn_at_;  // T_map_base of each keyframe in the grid
  std::size_t next_redrawn_ = 0;
  std::vector<ClearedRegion> cleared_;
};

}  // namespace nodmap::slam2d
