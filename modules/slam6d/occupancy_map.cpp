// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy_map.hpp"

#include <cmath>
#include <vector>

#include "modules/slam6d/beam.hpp"
#include "modules/slam6d/cloud_voxels.hpp"
#include "modules/slam6d/log_odds_map.hpp"
#include "modules/slam6d/octree_encoder.hpp"
#include "modules/slam6d/octree_grid.hpp"

namespace nodmap::slam6d {
namespace {

// Beyond this, where no octree reaches, OctoMap's integers would overflow.
constexpr float kFarthestM = 1e6F;

// As many as are near each other in the processor's cache.
constexpr std::size_t kBeamsAtOnce = 1024;

bool is_near(const Eigen::Vector3f& p) {
  return (p.array().abs() < kFarthestM).all();
}

}  // namespace

struct OccupancyMap::Map {
  explicit Map(const Options& settings) : options(settings), grid(settings.resolution_m) {
    beams.reserve(kBeamsAtOnce);
  }

  void trace(const SweepCloud& cloud, const geometry::SE3& T_map_base);
  void add_beam(const Eigen::Vector3f& p_map);
  void walk_beams();

  Options options;
  OctreeGrid grid;
  LogOddsMap log_odds;
  std::optional<std::size_t> num_nodes;  // where they have been counted

  // Of the cloud that is being inserted; kept for their memory.
  CloudVoxels voxels;
  CloudVoxels ends;                                        // of its beams
  std::vector<Beam> beams;                                 // not yet walked
  Eigen::Vector3f p_map_origin = Eigen::Vector3f::Zero();  // of the sensor, for these beams
  std::optional<VoxelKey> origin;
};

void OccupancyMap::Map::trace(const SweepCloud& cloud, const geometry::SE3& T_map_base) {
  voxels.clear();
  ends.clear();
  std::size_t i = 0;
  for (const SweepCloud::Line& line : cloud.lines) {
    p_map_origin = (T_map_base * line.p_base_mirror.cast<double>()).cast<float>();
    if (!is_near(p_map_origin)) {
      i = line.end;
      continue;
    }
    origin = grid.key_of(p_map_origin);
    for (; i < line.end; ++i) {
      const Eigen::Vector3f p_map = (T_map_base * cloud.points[i].cast<double>()).cast<float>();
      if (!is_near(p_map)) {
        continue;
      }
      if (!options.discretize) {
        add_beam(p_map);
      } else if (const VoxelKey end = grid.wrapped_key_of(p_map);
                 ends.mark_occupied(code_of(end))) {
        add_beam(grid.center_of(end));
      }
    }
  }
  walk_beams();
}

// As in OctoMap's computeUpdate().
void OccupancyMap::Map::add_beam(const Eigen::Vector3f& p_map) {
  const Eigen::Vector3f beam = p_map - p_map_origin;
  const double length_m = length_of(beam);
  const bool ends_inside = length_m <= options.max_range_m;
  const Eigen::Vector3f p_map_end =
      ends_inside ? p_map
                  : p_map_origin + beam / static_cast<float>(length_m) *
                                       static_cast<float>(options.max_range_m);
  const auto end = grid.key_of(p_map_end);
  if (!end) {
    return;
  }
  if (ends_inside) {
    voxels.mark_occupied(code_of(*end));
  }
  if (!origin || *origin == *end) {
    return;
  }
  beams.push_back(make_beam(grid, p_map_origin, *origin, p_map_end, *end));
  if (beams.size() == kBeamsAtOnce) {
    walk_beams();
  }
}

void OccupancyMap::Map::walk_beams() {
  walk(beams, voxels);
  beams.clear();
}

OccupancyMap::OccupancyMap(const Options& options) : map_(std::make_unique<Map>(options)) {}
OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

void OccupancyMap::insert(const SweepCloud& cloud, const geometry::SE3& T_map_base) {
  map_->trace(cloud, T_map_base);
  map_->log_odds.update(map_->voxels);
  map_->num_nodes.reset();
}

std::optional<std::string> OccupancyMap::encode(Format format) const {
  return format == Format::kBt ? encode_bt(map_->log_odds, map_->grid.resolution_m())
                               : encode_ot(map_->log_odds, map_->grid.resolution_m());
}

std::size_t OccupancyMap::num_nodes() const {
  if (!map_->num_nodes) {
    map_->num_nodes = count_nodes(map_->log_odds);
  }
  return *map_->num_nodes;
}
std::size_t OccupancyMap::memory_bytes() const {
  return map_->log_odds.memory_bytes() + map_->voxels.memory_bytes() + map_->ends.memory_bytes() +
         map_->beams.capacity() * sizeof(Beam);
}

}  // namespace nodmap::slam6d
