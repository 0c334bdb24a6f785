// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/test/octomap_bytes.hpp"

#include <cstdint>
#include <sstream>

namespace nodmap::foxglove::test {
namespace {

using Keys = std::vector<std::array<int, 3>>;

/// The node `level` levels above these voxels, and all below it.
void append_node(std::string& bytes, int level, const Keys& keys) {
  std::array<Keys, 8> children;
  for (const auto& key : keys) {
    const auto bit = [&](int axis) {
      return key[static_cast<std::size_t>(axis)] >> (level - 1) & 1;
    };
    children[static_cast<std::size_t>(bit(0) | bit(1) << 1 | bit(2) << 2)].push_back(key);
  }
  unsigned states = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const unsigned state = children[i].empty() ? 0U : level == 1 ? 2U : 3U;
    states |= state << (2 * i);
  }
  bytes.push_back(static_cast<char>(states & 0xFFU));
  bytes.push_back(static_cast<char>(states >> 8U));
  for (const Keys& child : children) {
    if (!child.empty() && level > 1) {
      append_node(bytes, level - 1, child);
    }
  }
}

}  // namespace

std::string octomap_bytes(double voxel_m, const std::vector<std::array<int, 3>>& voxels) {
  constexpr int kOriginKey = 32768;
  Keys keys;
  for (const auto& voxel : voxels) {
    keys.push_back({voxel[0] + kOriginKey, voxel[1] + kOriginKey, voxel[2] + kOriginKey});
  }
  std::ostringstream head;
  head << "# Octomap OcTree binary file\n# made up for a test\nid OcTree\nsize 0\nres " << voxel_m
       << "\ndata\n";
  std::string bytes = head.str();
  if (!keys.empty()) {
    append_node(bytes, 16, keys);
  }
  return bytes;
}

}  // namespace nodmap::foxglove::test
