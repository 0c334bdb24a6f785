// SPDX-License-Identifier: BSD-3-Clause
// Assembles maps and clouds from their numbered parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/formats/octomap_file.hpp"
#include "common/geometry/time.hpp"
#include "common/node/map_revision.hpp"
#include "modules/viewer/foxglove/sensor_views.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"

namespace nodmap::foxglove {

/// The result of adding a part.
template <class Whole>
struct Assembled {
  std::optional<Whole> whole;  ///< the map or cloud that this part completes
  bool refused = false;        ///< the part contradicts itself or previous parts
  bool lost = false;           ///< the previous map or cloud was incomplete and has been dropped
};

/// Assembles MAP_2D. A revision contains the tiles that have changed and, in turn, some of the
/// others. So the grid is complete once each tile has been received; until then the missing cells
/// are unknown.
class GridAssembler {
 public:
  /// The largest grid accepted: 4096 x 4096 cells, 200 m at 5 cm. A part may claim any size.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 24U;

  /// Returns the present grid when a revision is complete. A lost tile is sent again in its turn.
  [[nodiscard]] Assembled<GridView> add(const nodmap::grid_chunk_t& tile);

 private:
  void begin_revision(const nodmap::grid_chunk_t& tile);
  void resize_grid(const nodmap::grid_chunk_t& tile);

  node::MapRevision newest_;
  std::int64_t revision_ = -1;
  std::vector<bool> seen_;  ///< tiles of this revision that were received
  std::int32_t missing_ = 0;
  GridView grid_;
};

/// Follows numbered parts that arrive in order.
class PartsInOrder {
 public:
  struct Place {
    bool taken = false;  ///< the part is the next one
    /// The previous whole was incomplete, or the first parts of this one are missing.
    bool lost = false;
    bool is_first = false;
    bool is_last = false;
  };

  /// `whole`: the number of the map or cloud; 0 <= index < count.
  [[nodiscard]] Place add(std::int64_t whole, std::int32_t index, std::int32_t count);

 private:
  std::int64_t whole_ = 0;
  std::int32_t next_ = 0;  // 0: between two wholes
  std::int32_t count_ = 0;
};

/// Assembles a keyframe of CLOUD from parts that arrive in order. If one is lost the keyframe is
/// dropped and counted, because a cloud with gaps would look like free space.
class CloudAssembler {
 public:
  static constexpr std::int32_t kMaxChunks = 512;
  /// Several times what a sweep of any robot measures: 24 MB. Anybody can send chunks that are
  /// larger than those of 6D SLAM.
  static constexpr std::size_t kMaxPoints = 2'000'000;

  [[nodiscard]] Assembled<CloudView> add(const nodmap::cloud_chunk_t& chunk);

 private:
  PartsInOrder parts_;
  CloudView cloud_;
};

/// A received OctoMap.
struct OctomapView {
  time::Timestamp stamp{};
  formats::OccupiedSpace space;  ///< in frame map_6d
};

/// Assembles a revision of OCTOMAP and parses it.
class OctomapAssembler {
 public:
  /// 64 KiB each: 4 MB, about a hundred million voxels of a building.
  static constexpr std::int32_t kMaxChunks = 64;

  [[nodiscard]] Assembled<OctomapView> add(const nodmap::octomap_chunk_t& chunk);

 private:
  PartsInOrder parts_;
  std::string file_;
};

}  // namespace nodmap::foxglove
