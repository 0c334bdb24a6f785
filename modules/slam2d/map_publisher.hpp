// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/grid/occupancy_grid.hpp"

namespace nodmap::slam2d {

/// Publishes a grid as MAP_2D, tile by tile.
class MapPublisher {
 public:
  /// `period`: between two revisions of the map.
  MapPublisher(bus::Bus& bus, time::Duration period) : bus_(bus), period_(period) {}

  /// Publishes what has changed, and a few other tiles in turn, if a revision is due. `stamp`: of
  /// the newest measurement in the map.
  void publish_if_due(const OccupancyGrid& grid, time::Timestamp stamp);
  /// Publishes all that has changed at once.
  void publish_rest(const OccupancyGrid& grid, time::Timestamp stamp);

  /// Number of revisions so far.
  [[nodiscard]] std::int64_t num_published() const { return num_published_; }

 private:
  void publish(const OccupancyGrid& grid, time::Timestamp stamp, std::vector<GridTile> tiles);

  bus::Bus& bus_;
  time::Duration period_;
  TileSelector selector_;
  std::int64_t num_published_ = 0;
  std::optional<time::Timestamp> published_;  // stamp of the last revision
};

}  // namespace nodmap::slam2d
