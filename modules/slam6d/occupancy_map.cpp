// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy_map.hpp"

#include <octomap/octomap.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "modules/slam6d/voxel_blocks.hpp"

namespace nodmap::slam6d {
namespace {

using Node = octomap::OcTreeNode;
using Block = VoxelBlocks::Block;
using octomap::OcTreeKey;
using octomap::point3d;

// Beyond this, where no octree reaches, OctoMap's integers would overflow.
constexpr float kFarthestM = 1e6F;

point3d to_octomap(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

bool is_near(const point3d& p) {
  return std::abs(p.x()) < kFarthestM && std::abs(p.y()) < kFarthestM &&
         std::abs(p.z()) < kFarthestM;
}

constexpr std::uint64_t low_bits(unsigned count) {
  return count < 64U ? (std::uint64_t{1} << count) - 1U : ~std::uint64_t{0};
}

/// OctoMap's tree, updated for a whole cloud in one walk. updateNode() walks down from the root and
/// prunes back up to it for each voxel. Here each inner node is pruned once, after its children,
/// and voxels that are all alike are one leaf from the start. A leaf's value depends on its own
/// hits and misses only and the pruned tree on the leaves only: the result is the same, bit by bit.
class Octree : public octomap::OcTree {
 public:
  using octomap::OcTree::OcTree;

  /// `blocks` in Morton order, each not more than once.
  void update(std::span<const Block> blocks);

  // OctoMap's own write() and writeBinary() print to stderr; the format is the same.
  void write_bt(std::ostream& out) const {
    write_header(out, binaryFileHeader);
    writeBinaryData(out);
  }

  void write_ot(std::ostream& out) const {
    write_header(out, fileHeader);
    writeData(out);
  }

 private:
  static constexpr unsigned kBlockDepth = 16 - VoxelBlocks::kLevels;

  /// What a cloud says about the voxels of a cube, a bit for each.
  struct Marks {
    std::uint64_t free = 0;
    std::uint64_t occupied = 0;
    [[nodiscard]] bool any() const { return (free | occupied) != 0U; }
  };
  struct Child {
    Node* node = nullptr;
    bool is_new = false;
  };

  void update(Child at, unsigned depth, std::span<const Block> blocks);
  void update(Child at, const Block& block);
  void update(Child at, Marks marks, unsigned voxels);
  [[nodiscard]] Child child_of(Child parent, unsigned index);
  [[nodiscard]] bool changes_nothing(const Node& leaf, Marks marks) const;
  void settle(Node& parent);

  void write_header(std::ostream& out, const std::string& first_line) const {
    out << first_line
        << "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
        << "id " << getTreeType() << "\nsize " << size() << "\nres " << getResolution()
        << "\ndata\n";
  }
};

void Octree::update(std::span<const Block> blocks) {
  if (blocks.empty()) {
    return;
  }
  const bool is_new = root == nullptr;
  if (is_new) {
    root = new Node();  // OctoMap owns and deletes it
    ++tree_size;
  }
  update({root, is_new}, 0, blocks);
}

// Above the blocks: the blocks of each child follow one another.
void Octree::update(Child at, unsigned depth, std::span<const Block> blocks) {
  if (depth == kBlockDepth) {
    update(at, blocks.front());
    return;
  }
  const unsigned shift = 3U * (kBlockDepth - 1U - depth);
  while (!blocks.empty()) {
    const std::uint64_t code = blocks.front().code >> shift;
    const auto others = std::ranges::find_if(
        blocks, [&](const Block& block) { return block.code >> shift != code; });
    const auto count = static_cast<std::size_t>(others - blocks.begin());
    update(child_of(at, static_cast<unsigned>(code & 7U)), depth + 1, blocks.first(count));
    blocks = blocks.subspan(count);
  }
  settle(*at.node);
}

void Octree::update(Child at, const Block& block) {
  for (unsigned i = 0; i < 8; ++i) {
    if (const Marks marks{block.free[i], block.occupied[i]}; marks.any()) {
      update(child_of(at, i), marks, 64);
    }
  }
  settle(*at.node);
}

// The cube has 64, 8 or 1 voxels, the lowest bits of the marks.
void Octree::update(Child at, Marks marks, unsigned voxels) {
  if (!nodeHasChildren(at.node)) {
    const std::uint64_t all = low_bits(voxels);
    if (marks.free == all || marks.occupied == all) {
      updateNodeLogOdds(at.node, marks.free == all ? prob_miss_log : prob_hit_log);
      return;
    }
    if (!at.is_new && changes_nothing(*at.node, marks)) {
      return;
    }
  }
  const unsigned part = voxels / 8U;
  const std::uint64_t part_of_all = low_bits(part);
  for (unsigned i = 0; i < 8; ++i) {
    const Marks child{marks.free >> i * part & part_of_all,
                      marks.occupied >> i * part & part_of_all};
    if (child.any()) {
      update(child_of(at, i), child, part);
    }
  }
  settle(*at.node);
}

// As in OctoMap's updateNodeRecurs().
Octree::Child Octree::child_of(Child parent, unsigned index) {
  if (!nodeChildExists(parent.node, index)) {
    if (parent.is_new || nodeHasChildren(parent.node)) {
      return {createNodeChild(parent.node, index), true};
    }
    expandNode(parent.node);  // it was pruned
  }
  return {getNodeChild(parent.node, index), false};
}

bool Octree::changes_nothing(const Node& leaf, Marks marks) const {
  return (marks.occupied == 0U && leaf.getLogOdds() <= clamping_thres_min) ||
         (marks.free == 0U && leaf.getLogOdds() >= clamping_thres_max);
}

void Octree::settle(Node& parent) {
  if (!pruneNode(&parent)) {
    parent.updateOccupancyChildren();
  }
}

}  // namespace

struct OccupancyMap::Tree {
  explicit Tree(const Options& settings) : options(settings), octree(settings.resolution_m) {}

  void trace(const SweepCloud& cloud, const geometry::SE3& T_map_base);
  void trace_beam(const point3d& p_map_mirror, const point3d& p_map);

  Options options;
  Octree octree;
  VoxelBlocks voxels;  // kept for their memory, these three
  VoxelBlocks ends;    // of this cloud's beams
  octomap::KeyRay ray;
};

void OccupancyMap::Tree::trace(const SweepCloud& cloud, const geometry::SE3& T_map_base) {
  voxels.clear();
  ends.clear();
  std::size_t i = 0;
  for (const SweepCloud::Line& line : cloud.lines) {
    const point3d p_map_mirror = to_octomap(T_map_base * line.p_base_mirror.cast<double>());
    for (; i < line.end; ++i) {
      const point3d p_map = to_octomap(T_map_base * cloud.points[i].cast<double>());
      if (!is_near(p_map_mirror) || !is_near(p_map)) {
        continue;
      }
      if (!options.discretize) {
        trace_beam(p_map_mirror, p_map);
      } else if (const OcTreeKey end = octree.coordToKey(p_map);
                 ends.add_occupied({end[0], end[1], end[2]})) {
        trace_beam(p_map_mirror, octree.keyToCoord(end));
      }
    }
  }
}

// As in OctoMap's computeUpdate().
void OccupancyMap::Tree::trace_beam(const point3d& p_map_mirror, const point3d& p_map) {
  const point3d beam = p_map - p_map_mirror;
  const bool ends_inside = beam.norm() <= options.max_range_m;
  const point3d p_map_end =
      ends_inside ? p_map
                  : p_map_mirror + beam.normalized() * static_cast<float>(options.max_range_m);
  OcTreeKey start;
  OcTreeKey end;
  if (!octree.coordToKeyChecked(p_map_mirror, start) || !octree.coordToKeyChecked(p_map_end, end)) {
    return;
  }
  octree.computeRayKeys(p_map_mirror, p_map_end, ray);
  for (const OcTreeKey& key : ray) {
    voxels.add_free({key[0], key[1], key[2]});
  }
  if (ends_inside) {
    voxels.add_occupied({end[0], end[1], end[2]});
  }
}

OccupancyMap::OccupancyMap(const Options& options) : tree_(std::make_unique<Tree>(options)) {}
OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

void OccupancyMap::insert(const SweepCloud& cloud, const geometry::SE3& T_map_base) {
  tree_->trace(cloud, T_map_base);
  tree_->octree.update(tree_->voxels.sorted());
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
