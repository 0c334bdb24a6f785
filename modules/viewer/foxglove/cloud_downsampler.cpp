// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/cloud_downsampler.hpp"

#include <cmath>

namespace nodmap::foxglove {
namespace {

// Number of cubes along an axis on either side of the origin; limited by the bits of a block's key.
constexpr double kReach = 1 << 22;

std::uint64_t bits_of(std::int32_t block) {
  constexpr std::uint64_t k20Bits = (1U << 20U) - 1U;
  return static_cast<std::uint32_t>(block) & k20Bits;
}

// The key of the block that contains a cube.
std::uint64_t key_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  return bits_of(x >> 3) << 40U | bits_of(y >> 3) << 20U | bits_of(z >> 3);
}

// The index of a cube within its block.
std::size_t place_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  return static_cast<std::size_t>((x & 7) << 6 | (y & 7) << 3 | (z & 7));
}

}  // namespace

CloudDownsampler::CloudDownsampler(double spacing_m, std::size_t max_points)
    : spacing_m_(spacing_m), max_points_(max_points), next_forgetting_(max_points) {}

void CloudDownsampler::downsample(CloudView& cloud) {
  if (spacing_m_ <= 0.0) {
    return;
  }
  std::vector<float> kept;
  for (std::size_t i = 0; i + 2 < cloud.xyz_m.size(); i += 3) {
    const Eigen::Vector3f point(cloud.xyz_m[i], cloud.xyz_m[i + 1], cloud.xyz_m[i + 2]);
    if (const auto cube = cube_of(cloud.T_frame_points * point.cast<double>())) {
      if (is_shown(*cube)) {
        continue;
      }
      take(*cube);
    }
    ++kept_;
    kept.insert(kept.end(), {point.x(), point.y(), point.z()});
  }
  cloud.xyz_m = std::move(kept);
  if (kept_ >= next_forgetting_) {
    forget();
  }
}

void CloudDownsampler::clear() {
  *this = CloudDownsampler(spacing_m_, max_points_);
}

std::optional<CloudDownsampler::Cube> CloudDownsampler::cube_of(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d place = (p / spacing_m_).array().floor();
  // Written so that NaN also counts as out of reach.
  if (!(place.cwiseAbs().maxCoeff() < kReach) || !place.allFinite()) {
    return std::nullopt;
  }
  return Cube{static_cast<std::int32_t>(place.x()), static_cast<std::int32_t>(place.y()),
              static_cast<std::int32_t>(place.z())};
}

bool CloudDownsampler::is_taken(const Cube& cube) const {
  const auto found = blocks_.find(key_of(cube.x, cube.y, cube.z));
  return found != blocks_.end() && found->second.taken[place_of(cube.x, cube.y, cube.z)] &&
         !is_forgotten(found->second);
}

bool CloudDownsampler::is_shown(const Cube& cube) const {
  for (std::int32_t x = cube.x - 1; x <= cube.x + 1; ++x) {
    for (std::int32_t y = cube.y - 1; y <= cube.y + 1; ++y) {
      for (std::int32_t z = cube.z - 1; z <= cube.z + 1; ++z) {
        if (is_taken({x, y, z})) {
          return true;
        }
      }
    }
  }
  return false;
}

void CloudDownsampler::take(const Cube& cube) {
  Block& block = blocks_[key_of(cube.x, cube.y, cube.z)];
  if (is_forgotten(block)) {
    block.taken.reset();
  }
  block.taken.set(place_of(cube.x, cube.y, cube.z));
  block.touched = kept_;
}

bool CloudDownsampler::is_forgotten(const Block& block) const {
  return kept_ - block.touched > max_points_;
}

void CloudDownsampler::forget() {
  std::erase_if(blocks_, [this](const auto& entry) { return is_forgotten(entry.second); });
  next_forgetting_ = kept_ + max_points_;
}

}  // namespace nodmap::foxglove
