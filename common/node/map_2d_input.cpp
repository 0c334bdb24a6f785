// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_2d_input.hpp"

#include <utility>

#include "common/node/map_tile.hpp"

namespace nodmap::node {

bool Map2dInput::follow_pose() {
  const bus::Sender sender = bus_.origin().sender;
  const auto before = std::exchange(pose_sender_, sender);
  if (!before || *before == sender) {
    return false;
  }
  revision_ = {};
  return true;
}

std::optional<Map2dInput::Tile> Map2dInput::read(const nodmap::grid_chunk_t& message) {
  const auto tile = read_map_tile(message);
  if (!tile) {
    counts_.reject("implausible_map_tile");
    return std::nullopt;
  }
  if (pose_sender_ != bus_.origin().sender) {
    counts_.reject("map_tile_without_pose");
    return std::nullopt;
  }
  const MapRevision::Tile revision = revision_.classify(message.map_revision);
  if (revision == MapRevision::Tile::kLate) {
    counts_.reject("map_tile_of_older_revision");
    return std::nullopt;
  }
  return Tile{*tile, revision == MapRevision::Tile::kOfNewMap};
}

}  // namespace nodmap::node
