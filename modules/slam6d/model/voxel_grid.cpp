// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_grid.hpp"

#include <algorithm>
#include <cmath>

#include "modules/slam6d/model/plane_normal.hpp"

namespace nodmap::slam6d {
namespace {

constexpr std::int32_t kHalfRange = 1 << 20;
constexpr float kMaxSlackVoxels = 0.1F;

// std::floor is a call without SSE4.1.
std::int32_t floor_to_int(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - static_cast<std::int32_t>(x < static_cast<float>(truncated));
}

// The place of a point's voxel; empty if it is out of reach. `p_voxels`: the point, in voxels.
std::optional<VoxelPlace> place_of(const Eigen::Vector3f& p_voxels) {
  // One voxel of margin, so that neighbours have places, too. NaN fails the comparison.
  constexpr auto kReach = static_cast<float>(kHalfRange - 2);
  if (!(std::abs(p_voxels.x()) < kReach && std::abs(p_voxels.y()) < kReach &&
        std::abs(p_voxels.z()) < kReach)) {
    return std::nullopt;
  }
  return VoxelPlace{floor_to_int(p_voxels.x()) + kHalfRange,
                    floor_to_int(p_voxels.y()) + kHalfRange,
                    floor_to_int(p_voxels.z()) + kHalfRange};
}

// Part by part: a comparison of the whole would have to wait until all parts are stored.
bool are_same(const VoxelPlace& a, const VoxelPlace& b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

// For each axis, the step from the voxel of a point to the neighbour that the point is nearer to.
VoxelPlace steps_towards(const Eigen::Vector3f& p_voxels, const VoxelPlace& place) {
  const auto step = [&](int axis) {
    const std::int32_t border = place[static_cast<std::size_t>(axis)] - kHalfRange;
    return p_voxels[axis] - static_cast<float>(border) < 0.5F ? -1 : 1;
  };
  return {step(0), step(1), step(2)};
}

// The voxel nearest to a point, and the distance of the second nearest.
struct NearestTwo {
  float best_sq_m2 = 0.0F;  // at first of the reach
  float second_sq_m2 = 0.0F;
  std::uint32_t best = VoxelGrid::kNone;

  // Without branches, which could not be foretold.
  void add(std::uint32_t voxel, float sq_m2) {
    best = sq_m2 < best_sq_m2 ? voxel : best;
    second_sq_m2 = std::max(best_sq_m2, std::min(second_sq_m2, sq_m2));
    best_sq_m2 = std::min(best_sq_m2, sq_m2);
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
    : voxel_size_m_(voxel_size_m), per_m_(static_cast<float>(1.0 / voxel_size_m)) {}

double VoxelGrid::reach_m() const {
  return (kHalfRange - 2) * voxel_size_m_;
}

std::uint32_t VoxelGrid::voxel_at(const VoxelPlace& place) {
  const std::uint32_t voxel = index_.find_or_add(place);
  if (voxel == voxels_.size()) {
    voxels_.emplace_back();
  }
  return voxel;
}

// Successive beams of a scan often fall into the same voxel, which is looked up once.
std::vector<std::uint32_t> VoxelGrid::add(std::span<const Eigen::Vector3f> points) {
  std::vector<std::uint32_t> places;
  places.reserve(points.size());
  const std::size_t num_old = voxels_.size();
  for (std::size_t i = 0; i < num_old; ++i) {
    voxels_[i].mean *= voxels_[i].weight;
  }
  VoxelPlace last{};
  std::uint32_t voxel = kNone;
  for (const Eigen::Vector3f& p : points) {
    const auto place = place_of(p * per_m_);
    if (!place) {
      places.push_back(kNone);
      continue;
    }
    if (voxel == kNone || !are_same(*place, last)) {
      voxel = voxel_at(*place);
      last = *place;
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
  const auto place = place_of(mean * per_m_);
  if (!place) {
    return kNone;
  }
  const std::uint32_t number = voxel_at(*place);
  Voxel& voxel = voxels_[number];
  voxel.weight += weight;
  voxel.mean += (weight / voxel.weight) * (mean - voxel.mean);
  return number;
}

void VoxelGrid::find_planes(const Eigen::Vector3f& p_sensor, const PlaneParams& params) {
  std::vector<Moments> moments(voxels_.size());
  index_.for_each_with_others([&](std::uint32_t i, std::span<const std::uint32_t> others) {
    Moments here = moments[i];
    for (const std::uint32_t j : others) {
      const Eigen::Vector3f d = voxels_[j].mean - voxels_[i].mean;
      here.add(d);
      moments[j].add(-d);
    }
    moments[i] = here;
  });
  const auto min_count = static_cast<float>(params.min_neighbours);
  const auto max_thickness = static_cast<float>(params.max_thickness);
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    Voxel& voxel = voxels_[i];
    voxel.normal.setZero();
    voxel.normal_weight = 0.0F;
    if (moments[i].count < min_count) {
      continue;
    }
    if (const auto normal = plane_normal(moments[i].covariance(), max_thickness)) {
      voxel.normal =
          normal->dot(p_sensor - voxel.mean) < 0.0F ? Eigen::Vector3f(-*normal) : *normal;
      voxel.normal_weight = voxel.weight;
    }
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
  const Eigen::Vector3f p_voxels = p * per_m_;
  const auto place = place_of(p_voxels);
  if (!place) {
    return {kNone, most_slack_m};
  }
  const float reach_sq_m2 = max_distance_m * max_distance_m;
  NearestTwo nearest{reach_sq_m2, reach_sq_m2};
  const VoxelIndex::Corners corners = index_.corners(*place, steps_towards(p_voxels, *place));
  for (const std::uint32_t voxel : corners.numbers()) {
    nearest.add(voxel, (voxels_[voxel].mean - p).squaredNorm());
  }
  if (nearest.best == kNone) {
    return {kNone, most_slack_m};
  }
  // Once `p` has moved by half of the difference, the second may be as near.
  const float difference_m = std::sqrt(nearest.second_sq_m2) - std::sqrt(nearest.best_sq_m2);
  return {nearest.best, std::min(0.5F * difference_m, most_slack_m)};
}

std::size_t VoxelGrid::memory_bytes() const {
  return voxels_.capacity() * sizeof(Voxel) + index_.memory_bytes();
}

}  // namespace nodmap::slam6d
