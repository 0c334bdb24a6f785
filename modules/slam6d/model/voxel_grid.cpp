// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_grid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>

namespace nodmap::slam6d {
namespace {

constexpr int kBits = 21;
constexpr std::int32_t kHalfRange = 1 << (kBits - 1);
constexpr std::size_t kMinSlots = 1024;
constexpr float kMaxSlackVoxels = 0.1F;

constexpr std::uint64_t pack(std::int32_t x, std::int32_t y, std::int32_t z) {
  return (static_cast<std::uint64_t>(x) << (2 * kBits)) + (static_cast<std::uint64_t>(y) << kBits) +
         static_cast<std::uint64_t>(z);
}

// std::floor is a call without SSE4.1.
std::int32_t floor_to_int(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - static_cast<std::int32_t>(x < static_cast<float>(truncated));
}

// For each axis, the step from the voxel of a point to the neighbour that the point is nearer to.
// `p_voxels`: the point, in units of voxels.
std::array<std::uint64_t, 3> steps_towards(const Eigen::Vector3f& p_voxels) {
  std::array<std::uint64_t, 3> steps{};
  for (int axis = 0; axis < 3; ++axis) {
    const float in_voxel = p_voxels[axis] - static_cast<float>(floor_to_int(p_voxels[axis]));
    const std::uint64_t unit = std::uint64_t{1} << (kBits * (2 - axis));
    steps[static_cast<std::size_t>(axis)] = in_voxel < 0.5F ? std::uint64_t{0} - unit : unit;
  }
  return steps;
}

// Half of the 26 neighbours of a voxel, so that each pair of neighbours is looked up once.
constexpr std::array<std::uint64_t, 13> half_neighbourhood() {
  std::array<std::uint64_t, 13> offsets{};
  std::size_t n = 0;
  for (std::int32_t x = -1; x <= 1; ++x) {
    for (std::int32_t y = -1; y <= 1; ++y) {
      for (std::int32_t z = -1; z <= 1; ++z) {
        if (n < offsets.size() && 9 * x + 3 * y + z > 0) {
          offsets[n++] = pack(x, y, z);
        }
      }
    }
  }
  return offsets;
}

// The voxel nearest to a point, and the distance of the second nearest.
struct NearestTwo {
  float best_sq_m2 = 0.0F;  // at first of the reach
  float second_sq_m2 = 0.0F;
  std::uint32_t best = VoxelGrid::kNone;

  void add(std::uint32_t voxel, float sq_m2) {
    if (sq_m2 < best_sq_m2) {
      second_sq_m2 = best_sq_m2;
      best_sq_m2 = sq_m2;
      best = voxel;
    } else if (sq_m2 < second_sq_m2) {
      second_sq_m2 = sq_m2;
    }
  }
};

// First and second moments of the means about a voxel, relative to its own mean.
struct Moments {
  float count = 1.0F;  // the voxel itself
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float xx = 0.0F, xy = 0.0F, xz = 0.0F, yy = 0.0F, yz = 0.0F, zz = 0.0F;

  void add(const Eigen::Vector3f& d) {
    count += 1.0F;
    sum += d;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    xz += d.x() * d.z();
    yy += d.y() * d.y();
    yz += d.y() * d.z();
    zz += d.z() * d.z();
  }

  [[nodiscard]] Eigen::Matrix3f covariance() const {
    Eigen::Matrix3f second;
    second << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    const Eigen::Vector3f mean = sum / count;
    return second / count - mean * mean.transpose();
  }
};

}  // namespace

VoxelGrid::VoxelGrid(double voxel_size_m)
    : voxel_size_m_(voxel_size_m), per_m_(static_cast<float>(1.0 / voxel_size_m)) {
  rehash(kMinSlots);
}

double VoxelGrid::reach_m() const {
  return (kHalfRange - 2) * voxel_size_m_;
}

std::optional<VoxelGrid::Key> VoxelGrid::key_of(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f scaled = p * per_m_;
  // NaN fails this comparison. One voxel of margin, so that neighbours have keys, too.
  if (!(scaled.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < static_cast<float>(kHalfRange - 2))) {
    return std::nullopt;
  }
  return pack(floor_to_int(scaled.x()) + kHalfRange, floor_to_int(scaled.y()) + kHalfRange,
              floor_to_int(scaled.z()) + kHalfRange);
}

std::uint32_t VoxelGrid::find(Key key) const {
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = (key * 0x9E3779B97F4A7C15ULL) >> shift_;; i = (i + 1) & mask) {
    const std::uint32_t voxel = slots_[i];
    if (voxel == kNone || keys_[voxel] == key) {
      return voxel;
    }
  }
}

std::uint32_t VoxelGrid::find_or_add(Key key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = (key * 0x9E3779B97F4A7C15ULL) >> shift_;
  for (; slots_[i] != kNone; i = (i + 1) & mask) {
    if (keys_[slots_[i]] == key) {
      return slots_[i];
    }
  }
  const auto voxel = static_cast<std::uint32_t>(voxels_.size());
  slots_[i] = voxel;
  keys_.push_back(key);
  voxels_.emplace_back();
  if (2 * voxels_.size() > slots_.size()) {
    rehash(2 * slots_.size());
  }
  return voxel;
}

void VoxelGrid::rehash(std::size_t num_slots) {
  shift_ = 64 - std::countr_zero(num_slots);
  slots_.assign(num_slots, kNone);
  const std::size_t mask = num_slots - 1;
  for (std::uint32_t voxel = 0; voxel < keys_.size(); ++voxel) {
    std::size_t i = (keys_[voxel] * 0x9E3779B97F4A7C15ULL) >> shift_;
    while (slots_[i] != kNone) {
      i = (i + 1) & mask;
    }
    slots_[i] = voxel;
  }
}

// Successive beams of a scan often fall into the same voxel, which is looked up once.
std::vector<std::uint32_t> VoxelGrid::add(std::span<const Eigen::Vector3f> points) {
  std::vector<std::uint32_t> places;
  places.reserve(points.size());
  const std::size_t num_old = voxels_.size();
  for (std::size_t i = 0; i < num_old; ++i) {
    voxels_[i].mean *= voxels_[i].weight;
  }
  Key last_key = 0;
  std::uint32_t voxel = kNone;
  for (const Eigen::Vector3f& p : points) {
    const auto key = key_of(p);
    if (!key) {
      places.push_back(kNone);
      continue;
    }
    if (voxel == kNone || *key != last_key) {
      voxel = find_or_add(*key);
      last_key = *key;
    }
    voxels_[voxel].mean += p;
    voxels_[voxel].weight += 1.0F;
    places.push_back(voxel);
  }
  for (Voxel& v : voxels_) {
    v.mean /= v.weight;
  }
  return places;
}

std::uint32_t VoxelGrid::add(const Eigen::Vector3f& mean, float weight) {
  const auto key = key_of(mean);
  if (!key) {
    return kNone;
  }
  const std::uint32_t place = find_or_add(*key);
  Voxel& voxel = voxels_[place];
  voxel.weight += weight;
  voxel.mean += (weight / voxel.weight) * (mean - voxel.mean);
  return place;
}

void VoxelGrid::find_planes(const Eigen::Vector3f& p_sensor, const PlaneParams& params) {
  static constexpr auto kHalfNeighbourhood = half_neighbourhood();
  std::vector<Moments> moments(voxels_.size());
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    for (const Key offset : kHalfNeighbourhood) {
      const std::uint32_t j = find(keys_[i] + offset);
      if (j != kNone) {
        const Eigen::Vector3f d = voxels_[j].mean - voxels_[i].mean;
        moments[i].add(d);
        moments[j].add(-d);
      }
    }
  }
  const auto min_count = static_cast<float>(params.min_neighbours);
  const auto max_thickness = static_cast<float>(params.max_thickness);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    Voxel& voxel = voxels_[i];
    voxel.normal.setZero();
    voxel.normal_weight = 0.0F;
    if (moments[i].count < min_count) {
      continue;
    }
    eigen.computeDirect(moments[i].covariance());
    if (!(eigen.eigenvalues()[0] < max_thickness * eigen.eigenvalues()[1])) {
      continue;
    }
    const Eigen::Vector3f normal = eigen.eigenvectors().col(0);
    voxel.normal = normal.dot(p_sensor - voxel.mean) < 0.0F ? Eigen::Vector3f(-normal) : normal;
    voxel.normal_weight = voxel.weight;
  }
}

void VoxelGrid::add_normal(std::uint32_t voxel, const Eigen::Vector3f& normal, float weight) {
  Voxel& v = voxels_[voxel];
  v.normal_weight += weight;
  v.normal += (weight / v.normal_weight) * (normal - v.normal);
  const float length = v.normal.norm();
  // Two sides of a thin board cancel out.
  v.normal = length > 0.5F ? Eigen::Vector3f(v.normal / length) : Eigen::Vector3f::Zero();
}

VoxelGrid::Nearest VoxelGrid::find_nearest(const Eigen::Vector3f& p, float max_distance_m) const {
  const float most_slack_m = kMaxSlackVoxels * static_cast<float>(voxel_size_m_);
  const auto key = key_of(p);
  if (!key) {
    return {kNone, most_slack_m};
  }
  const float reach_sq_m2 = max_distance_m * max_distance_m;
  NearestTwo nearest{reach_sq_m2, reach_sq_m2};
  const std::array<Key, 3> side = steps_towards(p * per_m_);
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Key neighbour = *key + ((corner & 1U) != 0 ? side[0] : 0) +
                          ((corner & 2U) != 0 ? side[1] : 0) + ((corner & 4U) != 0 ? side[2] : 0);
    if (const std::uint32_t voxel = find(neighbour); voxel != kNone) {
      nearest.add(voxel, (voxels_[voxel].mean - p).squaredNorm());
    }
  }
  if (nearest.best == kNone) {
    return {kNone, most_slack_m};
  }
  // Once `p` has moved by half of the difference, the second may be as near.
  const float difference_m = std::sqrt(nearest.second_sq_m2) - std::sqrt(nearest.best_sq_m2);
  return {nearest.best, std::min(0.5F * difference_m, most_slack_m)};
}

std::size_t VoxelGrid::memory_bytes() const {
  return voxels_.capacity() * sizeof(Voxel) + keys_.capacity() * sizeof(Key) +
         slots_.capacity() * sizeof(std::uint32_t);
}

}  // namespace nodmap::slam6d
