// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/octree_encoder.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

namespace nodmap::slam6d {
namespace {

using Block = LogOddsMap::Block;
using Cube = LogOddsMap::Cube;
using Voxels = LogOddsMap::Voxels;

// A node as its parent sees it.
struct Node {
  bool exists = false;
  bool has_children = false;
  float log_odds = 0.0F;
};

// Eight siblings. The masks have a bit for each.
struct Siblings {
  std::array<float, 8> log_odds{};
  unsigned existing = 0;
  unsigned with_children = 0;

  void set(unsigned i, const Node& node) {
    log_odds[i] = node.log_odds;
    existing |= static_cast<unsigned>(node.exists) << i;
    with_children |= static_cast<unsigned>(node.has_children) << i;
  }

  [[nodiscard]] bool are_leaves_alike() const {
    bool alike = existing == 0xFFU && with_children == 0U;
    for (const float value : log_odds) {
      alike &= value == log_odds[0];
    }
    return alike;
  }

  [[nodiscard]] float highest() const {
    float highest = -std::numeric_limits<float>::infinity();
    for (unsigned i = 0; i < log_odds.size(); ++i) {
      highest = std::max(highest, (existing >> i & 1U) != 0U ? log_odds[i] : highest);
    }
    return highest;
  }

  // The children with a probability of at least one half.
  [[nodiscard]] unsigned occupied() const {
    unsigned bits = 0;
    for (unsigned i = 0; i < log_odds.size(); ++i) {
      bits |= static_cast<unsigned>(log_odds[i] >= 0.0F) << i;
    }
    return bits;
  }
};

// .bt: an inner node has two bytes, two bits for each child: none 0, free 1, occupied 2, inner 3.
// A leaf has none of its own.
class BtWriter {
 public:
  // Reserves space for an inner node, whose children follow; returns where.
  std::size_t begin_inner() {
    bytes_.append(2, '\0');
    return bytes_.size() - 2;
  }
  void end_inner(std::size_t at, const Siblings& children) {
    const unsigned leaves = children.existing & ~children.with_children;
    const unsigned occupied = children.occupied();
    const unsigned bits = spread(children.with_children | (leaves & ~occupied)) |
                          spread(children.with_children | (leaves & occupied)) << 1U;
    bytes_[at] = static_cast<char>(bits & 0xFFU);
    bytes_[at + 1] = static_cast<char>(bits >> 8U);
  }
  // Removes an inner node and all that followed.
  void take_back(std::size_t at) { bytes_.resize(at); }
  static void leaf(float) {}
  static void leaves(const Siblings&) {}

  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  // A zero behind each of the lowest eight bits.
  static unsigned spread(unsigned bits) {
    bits = (bits | bits << 4U) & 0x0F0FU;
    bits = (bits | bits << 2U) & 0x3333U;
    return (bits | bits << 1U) & 0x5555U;
  }

  std::string bytes_;
};

// .ot: each node has its log-odds and a byte with a bit for each child.
class OtWriter {
 public:
  std::size_t begin_inner() {
    leaf(0.0F);
    return bytes_.size() - kNodeBytes;
  }
  void end_inner(std::size_t at, const Siblings& children) {
    put(at, children.highest(), children.existing);
  }
  void take_back(std::size_t at) { bytes_.resize(at); }
  void leaf(float log_odds) {
    bytes_.resize(bytes_.size() + kNodeBytes);
    put(bytes_.size() - kNodeBytes, log_odds, 0);
  }
  void leaves(const Siblings& siblings) {
    for (unsigned i = 0; i < siblings.log_odds.size(); ++i) {
      if ((siblings.existing >> i & 1U) != 0U) {
        leaf(siblings.log_odds[i]);
      }
    }
  }

  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  static constexpr std::size_t kNodeBytes = sizeof(float) + 1;

  void put(std::size_t at, float log_odds, unsigned children) {
    std::memcpy(&bytes_[at], &log_odds, sizeof log_odds);
    bytes_[at + sizeof log_odds] = static_cast<char>(children);
  }

  std::string bytes_;
};

// Writes nothing: only the nodes are counted.
class NodeCounter {
 public:
  static std::size_t begin_inner() { return 0; }
  static void end_inner(std::size_t, const Siblings&) {}
  static void take_back(std::size_t) {}
  static void leaf(float) {}
  static void leaves(const Siblings&) {}
};

// From the root down, each node before its children, as OctoMap's files have them.
template <typename Writer>
class TreeWalk {
 public:
  TreeWalk(const LogOddsMap& map, Writer& writer) : writer_(writer) {
    std::vector<PlacedCube> cubes;
    cubes.reserve(map.cubes().size());
    for (const auto& [code, cube] : map.cubes()) {
      cubes.emplace_back(code, &cube);
    }
    if (!cubes.empty()) {
      write_cubes(cubes, kOctreeLevels - LogOddsMap::kCubeLevels);
    }
  }

  [[nodiscard]] std::size_t num_nodes() const { return num_nodes_; }

 private:
  using PlacedCube = std::pair<VoxelCode, const Cube*>;

  // Writes the node that is `levels` above the cubes and holds just these, in the order of their
  // codes.
  Node write_cubes(std::span<const PlacedCube> cubes, unsigned levels) {
    if (levels == 0) {
      return write_blocks(*cubes.front().second,
                          LogOddsMap::kCubeLevels - LogOddsMap::kBlockLevels);
    }
    return write_inner([&](unsigned child) {
      const unsigned shift = 3U * (levels - 1U);
      const auto end = std::ranges::find_if(
          cubes, [&](const PlacedCube& cube) { return (cube.first >> shift & 7U) != child; });
      const auto of_child = cubes.first(static_cast<std::size_t>(end - cubes.begin()));
      cubes = cubes.subspan(of_child.size());
      return of_child.empty() ? Node{} : write_cubes(of_child, levels - 1);
    });
  }

  Node write_blocks(std::span<const Block> blocks, unsigned levels) {
    if (levels == 0) {
      return write_block(blocks.front());
    }
    return write_inner([&](unsigned child) {
      const std::size_t part = blocks.size() / 8;
      return write_blocks(blocks.subspan(child * part, part), levels - 1);
    });
  }

  Node write_block(const Block& block) {
    if (!block.is_known) {
      return {};
    }
    return block.voxels ? write_voxels(*block.voxels) : write_leaf(block.log_odds);
  }

  Node write_voxels(const Voxels& voxels) {
    return write_inner([&](unsigned word) {
      return voxels.known[word] == 0U ? Node{} : write_inner([&](unsigned byte) {
        return write_octet(&voxels.log_odds[std::size_t{8} * (8 * word + byte)],
                           static_cast<unsigned>(voxels.known[word] >> 8U * byte) & 0xFFU);
      });
    });
  }

  // Writes the parent of eight voxels.
  Node write_octet(const float* log_odds, unsigned known) {
    if (known == 0U) {
      return {};
    }
    Siblings voxels{.existing = known};
    std::copy_n(log_odds, 8, voxels.log_odds.begin());
    if (voxels.are_leaves_alike()) {
      return write_leaf(log_odds[0]);
    }
    const std::size_t at = writer_.begin_inner();
    writer_.leaves(voxels);
    num_nodes_ += static_cast<std::size_t>(std::popcount(known));
    return end_inner(at, voxels);
  }

  // Writes an inner node, a leaf or nothing, depending on its children.
  template <typename WriteChild>
  Node write_inner(const WriteChild& write_child) {
    const std::size_t at = writer_.begin_inner();
    const std::size_t nodes_before = num_nodes_;
    Siblings children;
    for (unsigned i = 0; i < 8; ++i) {
      children.set(i, write_child(i));
    }
    if (children.existing != 0U && !children.are_leaves_alike()) {
      return end_inner(at, children);
    }
    writer_.take_back(at);
    num_nodes_ = nodes_before;
    return children.existing == 0U ? Node{} : write_leaf(children.log_odds[0]);
  }

  Node end_inner(std::size_t at, const Siblings& children) {
    writer_.end_inner(at, children);
    ++num_nodes_;
    return {true, true, children.highest()};
  }

  Node write_leaf(float log_odds) {
    writer_.leaf(log_odds);
    ++num_nodes_;
    return {true, false, log_odds};
  }

  Writer& writer_;
  std::size_t num_nodes_ = 0;
};

template <typename Writer>
std::string encode(const LogOddsMap& map, double resolution_m, const char* first_line) {
  Writer writer;
  const TreeWalk walk(map, writer);
  std::ostringstream head;
  head << first_line
       << "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
       << "id OcTree\nsize " << walk.num_nodes() << "\nres " << resolution_m << "\ndata\n";
  return head.str() + writer.bytes();
}

}  // namespace

std::string encode_bt(const LogOddsMap& map, double resolution_m) {
  return encode<BtWriter>(map, resolution_m, "# Octomap OcTree binary file");
}

std::string encode_ot(const LogOddsMap& map, double resolution_m) {
  return encode<OtWriter>(map, resolution_m, "# Octomap OcTree file");
}

std::size_t count_nodes(const LogOddsMap& map) {
  NodeCounter counter;
  return TreeWalk(map, counter).num_nodes();
}

}  // namespace nodmap::slam6d
