// SPDX-License-Identifier: BSD-3-Clause
// Maps and clouds that came in numbered parts, put together again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/formats/octomap_file.hpp"
#include "common/geometry/time.hpp"
#include "modules/viewer/foxglove/sensor_views.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"

namespace nodmap::foxglove {

/// What adding a part has led to.
template <class Whole>
struct Assembled {
  std::optional<Whole> whole;  ///< the map or cloud that this part made complete
  bool refused = false;        ///< the part contradicts itself or its predecessors
  bool lost = false;           ///< the one before it was given up incomplete
};

/// Puts MAP_2D together. A revision brings the tiles that have changed and some of the others in
/// turn, so the grid is whole once each tile was heard; until then what has not come is unknown.
class GridAssembler {
 public:
  /// The largest grid taken: 4096 x 4096 cells, 200 m at 5 cm. A part may claim any size.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 24U;

  /// Returns the grid as it is known when a revision is complete. A lost tile comes again in its
  /// turn.
  [[nodiscard]] Assembled<GridView> add(const nodmap::grid_chunk_t& tile);

 private:
  void begin_revision(const nodmap::grid_chunk_t& tile);
  void resize_grid(const nodmap::grid_chunk_t& tile);

  std::int64_t revision_ = -1;
  std::vector<bool> seen_;  ///< of the revision
  std::int32_t missing_ = 0;
  GridView grid_;
};

/// Follows parts that come in order, each whole under a number of its own.
class PartsInOrder {
 public:
  struct Place {
    bool taken = false;  ///< the part is the next one
    bool lost = false;   ///< a whole was given up before it, or its own beginning has not come
    bool is_first = false;
    bool is_last = false;
  };

  /// The numbers must be plausible: 0 <= index < count.
  [[nodiscard]] Place add(std::int64_t whole, std::int32_t index, std::int32_t count);

 private:
  std::int64_t whole_ = 0;
  std::int32_t next_ = 0;  // 0: none begun
  std::int32_t count_ = 0;
};

/// Puts a keyframe of CLOUD together. Parts come in order. When one is lost the keyframe is dropped
/// and counted: a cloud with holes would look like free space.
class CloudAssembler {
 public:
  /// 64 KiB each: more than two million points.
  static constexpr std::int32_t kMaxChunks = 512;

  [[nodiscard]] Assembled<CloudView> add(const nodmap::cloud_chunk_t& chunk);

 private:
  PartsInOrder parts_;
  CloudView cloud_;
};

/// An OctoMap as it came.
struct OctomapView {
  time::Timestamp stamp{};
  formats::OccupiedSpace space;  ///< in frame map_6d
};

/// Puts a revision of OCTOMAP together and reads it.
class OctomapAssembler {
 public:
  /// 64 KiB each: 4 MB, some hundred million voxels of a building.
  static constexpr std::int32_t kMaxChunks = 64;

  [[nodiscard]] Assembled<OctomapView> add(const nodmap::octomap_chunk_t& chunk);

 private:
  PartsInOrder parts_;
  std::string file_;
};

}  // namespace nodmap::foxglove
