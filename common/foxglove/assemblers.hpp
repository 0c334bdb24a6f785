// SPDX-License-Identifier: BSD-3-Clause
// Maps and clouds that came in numbered parts, put together again.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/foxglove/sensor_views.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/grid_chunk_t.hpp"

namespace nodmap::foxglove {

/// What became of a part.
template <class Whole>
struct Assembled {
  std::optional<Whole> whole;  ///< the map or cloud that this part made complete
  bool refused = false;        ///< the part contradicts itself or its predecessors
  bool lost = false;           ///< the one before it was given up incomplete
};

/// Puts MAP_2D together, tile by tile.
class GridAssembler {
 public:
  /// The largest grid taken: 4096 x 4096 cells, 200 m at 5 cm. A part may claim any size.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 24U;

  [[nodiscard]] Assembled<GridView> add(const nodmap::grid_chunk_t& tile);

 private:
  void begin(const nodmap::grid_chunk_t& tile);

  bool begun_ = false;
  std::int64_t revision_ = 0;
  std::vector<bool> seen_;
  std::int32_t missing_ = 0;
  GridView grid_;
};

/// Puts a keyframe of CLOUD together. Parts come in order; when one is lost the rest is of use, but
/// a picture with holes that nobody announces is not: the keyframe is given up, and counted.
class CloudAssembler {
 public:
  /// 64 KiB each: more than two million points.
  static constexpr std::int32_t kMaxChunks = 512;

  [[nodiscard]] Assembled<CloudView> add(const nodmap::cloud_chunk_t& chunk);

 private:
  std::int64_t keyframe_id_ = 0;
  std::int32_t next_chunk_ = 0;  // 0: none begun
  std::int32_t num_chunks_ = 0;
  CloudView cloud_;
};

}  // namespace nodmap::foxglove
