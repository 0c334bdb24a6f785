// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace nodmap::node {

/// Tells from the revisions of MAP_2D's tiles when 2D SLAM has begun another map: its revisions
/// count from the start again. One tile of a lower revision alone may be a late one of the map that
/// is known, so the second one in succession decides. The first one comes again in its turn.
class MapRevision {
 public:
  enum class Tile : std::uint8_t { kOfKnownMap, kLate, kOfNewMap };

  Tile classify(std::int64_t revision) {
    const bool is_lower = newest_ && revision < *newest_;
    if (is_lower && !std::exchange(last_was_lower_, true)) {
      return Tile::kLate;
    }
    newest_ = revision;
    last_was_lower_ = false;
    return is_lower ? Tile::kOfNewMap : Tile::kOfKnownMap;
  }

 private:
  std::optional<std::int64_t> newest_;
  bool last_was_lower_ = false;
};

}  // namespace nodmap::node
