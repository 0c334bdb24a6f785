// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/octomap_file.hpp"

#include <algorithm>
#include <charconv>

namespace nodmap::formats {
namespace {

constexpr std::string_view kFirstLine = "# Octomap OcTree binary file";
constexpr double kMinVoxelM = 1e-4;
constexpr double kMaxVoxelM = 1e3;

// The values of a child's two bits.
constexpr unsigned kOccupied = 2;
constexpr unsigned kInner = 3;

// Removes the first line and returns it; empty at the end.
std::string_view take_line(std::string_view& bytes) {
  const std::string_view line = bytes.substr(0, bytes.find('\n'));
  bytes.remove_prefix(std::min(line.size() + 1, bytes.size()));
  return line;
}

// Reads the head, up to the line "data". Returns the edge of a voxel, metres; empty if the head is
// invalid.
std::optional<double> take_head(std::string_view& bytes) {
  if (take_line(bytes) != kFirstLine) {
    return std::nullopt;
  }
  double voxel_m = 0.0;
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    if (line == "data") {
      const bool is_plausible = voxel_m >= kMinVoxelM && voxel_m <= kMaxVoxelM;
      return is_plausible ? std::optional(voxel_m) : std::nullopt;
    }
    if (line.starts_with("res ")) {
      std::from_chars(line.data() + 4, line.data() + line.size(), voxel_m);
    }
  }
  return std::nullopt;
}

class TreeReader {
 public:
  TreeReader(std::string_view bytes, std::vector<OccupiedSpace::Cube>& occupied)
      : bytes_(bytes), occupied_(occupied) {}

  // Reads an inner node and everything below it. Returns false if the bytes end too early or the
  // tree is too deep.
  // NOLINTNEXTLINE(misc-no-recursion): at most kLevels deep
  [[nodiscard]] bool read_node(OccupiedSpace::Cube node) {
    if (bytes_.size() < 2 || node.level == 0) {
      return false;
    }
    const unsigned children = static_cast<unsigned char>(bytes_[0]) |
                              static_cast<unsigned>(static_cast<unsigned char>(bytes_[1])) << 8U;
    bytes_.remove_prefix(2);
    for (unsigned i = 0; i < 8; ++i) {
      if ((children >> (2 * i) & 3U) == kOccupied) {
        occupied_.push_back(child_of(node, i));
      }
    }
    for (unsigned i = 0; i < 8; ++i) {
      if ((children >> (2 * i) & 3U) == kInner && !read_node(child_of(node, i))) {
        return false;
      }
    }
    return true;
  }

  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

 private:
  static OccupiedSpace::Cube child_of(OccupiedSpace::Cube node, unsigned index) {
    --node.level;
    for (unsigned axis = 0; axis < 3; ++axis) {
      node.key[axis] =
          static_cast<std::uint16_t>(node.key[axis] | (index >> axis & 1U) << node.level);
    }
    return node;
  }

  std::string_view bytes_;
  std::vector<OccupiedSpace::Cube>& occupied_;
};

}  // namespace

std::optional<OccupiedSpace> read_octomap(std::string_view bytes) {
  const auto voxel_m = take_head(bytes);
  if (!voxel_m) {
    return std::nullopt;
  }
  OccupiedSpace space;
  space.voxel_m = *voxel_m;
  if (bytes.empty()) {
    return space;  // a tree without a root
  }
  TreeReader reader(bytes, space.cubes);
  if (!reader.read_node({{}, OccupiedSpace::kLevels}) || !reader.at_end()) {
    return std::nullopt;
  }
  return space;
}

}  // namespace nodmap::formats
