// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy_map.hpp"

#include <octomap/octomap.h>

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace nodmap::slam6d {
namespace {

// A voxel's key with the bits of its three axes interleaved: sorted by it, voxels come in the order
// of the octree's leaves, and neighbours in the list are neighbours in memory.
using MortonCode = std::uint64_t;

// Beyond this, where no octree reaches, OctoMap's integers would overflow.
constexpr double kFarthestM = 1e6;

MortonCode spread_bits(std::uint16_t key) {
  MortonCode spread = key;
  spread = (spread | spread << 16U) & 0x0000FF0000FFULL;
  spread = (spread | spread << 8U) & 0x00F00F00F00FULL;
  spread = (spread | spread << 4U) & 0x0C30C30C30C3ULL;
  return (spread | spread << 2U) & 0x249249249249ULL;
}

std::uint16_t collect_bits(MortonCode code) {
  code &= 0x249249249249ULL;
  code = (code | code >> 2U) & 0x0C30C30C30C3ULL;
  code = (code | code >> 4U) & 0x00F00F00F00FULL;
  code = (code | code >> 8U) & 0x0000FF0000FFULL;
  return static_cast<std::uint16_t>((code | code >> 16U) & 0xFFFFU);
}

MortonCode morton(const octomap::OcTreeKey& key) {
  return spread_bits(key[0]) | spread_bits(key[1]) << 1U | spread_bits(key[2]) << 2U;
}

octomap::OcTreeKey key_of(MortonCode code) {
  return {collect_bits(code), collect_bits(code >> 1U), collect_bits(code >> 2U)};
}

void sort_unique(std::vector<MortonCode>& codes) {
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
}

octomap::point3d to_octomap(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

// OctoMap's own write() and writeBinary() print to stderr; the format is the same.
class Octree : public octomap::OcTree {
 public:
  using octomap::OcTree::OcTree;

  void write_bt(std::ostream& out) const {
    write_header(out, binaryFileHeader);
    writeBinaryData(out);
  }

  void write_ot(std::ostream& out) const {
    write_header(out, fileHeader);
    writeData(out);
  }

 private:
  void write_header(std::ostream& out, const std::string& first_line) const {
    out << first_line
        << "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
        << "id " << getTreeType() << "\nsize " << size() << "\nres " << getResolution()
        << "\ndata\n";
  }
};

}  // namespace

struct OccupancyMap::Tree {
  explicit Tree(const Options& settings) : options(settings), octree(settings.resolution_m) {}

  // The voxels that one cloud says something about, each once.
  struct Voxels {
    std::vector<MortonCode> occupied;
    std::vector<MortonCode> free;  // may hold occupied ones, too
  };

  [[nodiscard]] Voxels trace(const SweepCloud& cloud, const geometry::SE3& T_map_base);
  void trace_beam(const Eigen::Vector3d& p_map_mirror, const Eigen::Vector3d& p_map,
                  Voxels& voxels);

  Options options;
  Octree octree;
  octomap::KeyRay ray;                    // kept for its memory
  std::unordered_set<MortonCode> traced;  // ends of this cloud's beams; asked, never walked through
};

OccupancyMap::Tree::Voxels OccupancyMap::Tree::trace(const SweepCloud& cloud,
                                                     const geometry::SE3& T_map_base) {
  Voxels voxels;
  traced.clear();
  std::size_t i = 0;
  for (const SweepCloud::Line& line : cloud.lines) {
    const Eigen::Vector3d p_map_mirror = T_map_base * line.p_base_mirror.cast<double>();
    for (; i < line.end; ++i) {
      trace_beam(p_map_mirror, T_map_base * cloud.points[i].cast<double>(), voxels);
    }
  }
  sort_unique(voxels.occupied);
  sort_unique(voxels.free);
  return voxels;
}

void OccupancyMap::Tree::trace_beam(const Eigen::Vector3d& p_map_mirror,
                                    const Eigen::Vector3d& p_map, Voxels& voxels) {
  const Eigen::Vector3d beam = p_map - p_map_mirror;
  const double range_m = beam.norm();
  const bool ends_inside = range_m <= options.max_range_m;
  const Eigen::Vector3d p_map_end =
      ends_inside ? p_map : Eigen::Vector3d(p_map_mirror + beam * (options.max_range_m / range_m));
  octomap::OcTreeKey end;
  if (!(p_map_end.cwiseAbs().maxCoeff() < kFarthestM) ||
      !octree.coordToKeyChecked(to_octomap(p_map_end), end)) {
    return;
  }
  // A second beam of its kind into the same voxel says nothing new.
  if (!traced.insert(morton(end) << 1U | (ends_inside ? 1U : 0U)).second) {
    return;
  }
  if (ends_inside) {
    voxels.occupied.push_back(morton(end));
  }
  if (octree.computeRayKeys(to_octomap(p_map_mirror), to_octomap(p_map_end), ray)) {
    for (const octomap::OcTreeKey& key : ray) {
      voxels.free.push_back(morton(key));
    }
  }
}

OccupancyMap::OccupancyMap(const Options& options) : tree_(std::make_unique<Tree>(options)) {}
OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

void OccupancyMap::insert(const SweepCloud& cloud, const geometry::SE3& T_map_base) {
  const Tree::Voxels voxels = tree_->trace(cloud, T_map_base);
  Octree& octree = tree_->octree;
  auto occupied = voxels.occupied.begin();
  for (const MortonCode code : voxels.free) {
    for (; occupied != voxels.occupied.end() && *occupied < code; ++occupied) {
      octree.updateNode(key_of(*occupied), true);
    }
    if (occupied == voxels.occupied.end() || *occupied != code) {
      octree.updateNode(key_of(code), false);
    }
  }
  for (; occupied != voxels.occupied.end(); ++occupied) {
    octree.updateNode(key_of(*occupied), true);
  }
}

std::optional<std::string> OccupancyMap::encode(Format format) const {
  std::ostringstream bytes;
  if (format == Format::kBt) {
    tree_->octree.write_bt(bytes);
  } else {
    tree_->octree.write_ot(bytes);
  }
  return bytes ? std::optional(std::move(bytes).str()) : std::nullopt;
}

std::size_t OccupancyMap::num_nodes() const {
  return tree_->octree.size();
}
std::size_t OccupancyMap::memory_bytes() const {
  return tree_->octree.memoryUsage();
}

}  // namespace nodmap::slam6d
