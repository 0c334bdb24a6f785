// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/bus/bus.hpp"
#include "common/geometry/map_tile.hpp"
#include "common/node/map_revision.hpp"
#include "common/node/message_counts.hpp"
#include "nodmap/grid_chunk_t.hpp"

namespace nodmap::node {

/// Reads MAP_2D for modules that also use POSE_2D. A map must be in the frame of the poses, so it
/// is taken only from the process whose poses are used. That another process sends the poses, or
/// that the revision starts again, as in a recording, means that 2D SLAM has another map.
///
/// Causes of rejection: `implausible_map_tile`, `map_tile_without_pose` (no POSE_2D so far, or the
/// last one is from another process), `map_tile_of_older_revision`. A tile that is read is not yet
/// counted as used.
class Map2dInput {
 public:
  /// `bus`: delivers the messages, and knows their senders.
  Map2dInput(MessageCounts& counts, const bus::Bus& bus) : counts_(counts), bus_(bus) {}

  /// Follows the sender of the POSE_2D that is being handled. Returns whether it is another one
  /// than before, so that the known map is void.
  [[nodiscard]] bool follow_pose();

  struct Tile {
    geometry::MapTile tile;   ///< its cells are those of the message
    bool begins_map = false;  ///< the map known before is void
  };
  /// Empty when the message was rejected.
  [[nodiscard]] std::optional<Tile> read(const nodmap::grid_chunk_t& message);

 private:
  MessageCounts& counts_;
  const bus::Bus& bus_;
  std::optional<bus::Sender> pose_sender_;  // of the last POSE_2D
  MapRevision revision_;
};

}  // namespace nodmap::node
