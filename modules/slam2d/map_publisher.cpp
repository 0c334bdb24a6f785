// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/map_publisher.hpp"

#include <utility>

#include "common/node/messages.hpp"
#include "modules/slam2d/messages.hpp"
#include "nodmap/grid_chunk_t.hpp"

namespace nodmap::slam2d {

void MapPublisher::publish_if_due(const OccupancyGrid& grid, time::Timestamp stamp) {
  if (time::is_due(stamp, published_, period_)) {
    publish(grid, stamp, selector_.choose(grid));
  }
}

void MapPublisher::publish_rest(const OccupancyGrid& grid, time::Timestamp stamp) {
  publish(grid, stamp, selector_.choose_rest(grid));
}

void MapPublisher::publish(const OccupancyGrid& grid, time::Timestamp stamp,
                           std::vector<GridTile> tiles) {
  if (tiles.empty()) {
    return;
  }
  std::int32_t index = 0;
  for (GridTile& tile : tiles) {
    nodmap::grid_chunk_t message = write_tile(grid, std::move(tile));
    message.utime = time::to_utime(stamp);
    message.map_revision = num_published_;
    message.chunk_index = index++;
    message.num_chunks = static_cast<std::int32_t>(tiles.size());
    bus_.publish("MAP_2D", message);
  }
  ++num_published_;
  published_ = stamp;
}

}  // namespace nodmap::slam2d
