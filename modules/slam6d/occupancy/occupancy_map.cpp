// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/occupancy_map.hpp"

#include "modules/slam6d/occupancy/octree_encoder.hpp"

namespace nodmap::slam6d {

void OccupancyMap::insert(const SweepCloud& cloud, const geometry::SE3& T_map_base,
                          const std::vector<bool>& is_moved) {
  voxels_.clear();
  tracer_.trace(cloud, T_map_base, voxels_, is_moved);
  log_odds_.update(voxels_);
}

std::optional<std::string> OccupancyMap::encode(Format format) const {
  return format == Format::kBt ? encode_bt(log_odds_, resolution_m_)
                               : encode_ot(log_odds_, resolution_m_);
}

std::size_t OccupancyMap::num_nodes() const {
  return count_nodes(log_odds_);
}

std::size_t OccupancyMap::memory_bytes() const {
  return log_odds_.memory_bytes() + voxels_.memory_bytes() + tracer_.memory_bytes();
}

}  // namespace nodmap::slam6d
