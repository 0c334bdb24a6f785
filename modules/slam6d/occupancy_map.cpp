// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy_map.hpp"

#include "modules/slam6d/cloud_voxels.hpp"
#include "modules/slam6d/log_odds_map.hpp"
#include "modules/slam6d/octree_encoder.hpp"

namespace nodmap::slam6d {

struct OccupancyMap::Map {
  explicit Map(const TraceParams& params) : resolution_m(params.resolution_m), tracer(params) {}

  double resolution_m;
  CloudTracer tracer;
  CloudVoxels voxels;  // of the last cloud; kept to reuse their memory
  LogOddsMap log_odds;
  std::optional<std::size_t> num_nodes;  // empty until they are counted
};

OccupancyMap::OccupancyMap(const TraceParams& params) : map_(std::make_unique<Map>(params)) {}
OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

void OccupancyMap::insert(const SweepCloud& cloud, const geometry::SE3& T_map_base,
                          const std::vector<bool>& is_moved) {
  map_->voxels.clear();
  map_->tracer.trace(cloud, T_map_base, map_->voxels, is_moved);
  map_->log_odds.update(map_->voxels);
  map_->num_nodes.reset();
}

std::optional<std::string> OccupancyMap::encode(Format format) const {
  return format == Format::kBt ? encode_bt(map_->log_odds, map_->resolution_m)
                               : encode_ot(map_->log_odds, map_->resolution_m);
}

std::size_t OccupancyMap::num_nodes() const {
  if (!map_->num_nodes) {
    map_->num_nodes = count_nodes(map_->log_odds);
  }
  return *map_->num_nodes;
}
std::size_t OccupancyMap::memory_bytes() const {
  return map_->log_odds.memory_bytes() + map_->voxels.memory_bytes() + map_->tracer.memory_bytes();
}

}  // namespace nodmap::slam6d
