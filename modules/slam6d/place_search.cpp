// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/place_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A wall is seen within a cell and its neighbours: 20 to 40 cm away, which covers what half a step
// of the search in position and heading moves a point 5 m away.
constexpr float kCellM = 0.2F;
constexpr double kStepM = 0.3;
constexpr int kHeadings = 72;
// So far beside the keyframes the robot may be: it drives where it drove before.
constexpr double kReachM = 1.2;
constexpr std::size_t kMaxPoints = 300;
// Of the points near walls; with fewer no pose is looked at. And so many are, the best.
constexpr double kLeastPart = 0.5;
constexpr std::size_t kMaxCandidates = 5000;
// On fewer points of walls no place can be told.
constexpr std::size_t kMinPoints = 60;
// A building of 200 m x 200 m x 5 m, 25 MB. Beyond it nothing is searched.
constexpr double kMaxCells = 2.5e7;
constexpr std::size_t kWallLevel = 1;
constexpr float kMaxUprightNormal = 0.5F;  // height of the normal of a wall
// How far a start may be off.
constexpr double kSigmaM = 0.3;
constexpr double kSigmaHeightM = 0.05;
constexpr double kSigmaTiltRad = geometry::deg_to_rad(2.0);
constexpr double kSigmaHeadingRad = geometry::deg_to_rad(6.0);

Eigen::Matrix3d heading(int step) {
  return geometry::rotation_of({0.0, 0.0, 2.0 * geometry::kPi * step / kHeadings});
}

bool is_wall(const Voxel& voxel) {
  return voxel.has_plane() && std::abs(voxel.normal.z()) < kMaxUprightNormal;
}

PosePrior prior_at(const SE3& T_map_start) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << kSigmaM, kSigmaM, kSigmaHeightM, kSigmaTiltRad, kSigmaTiltRad, kSigmaHeadingRad;
  return {.T_map_base = T_map_start, .covariance = sigma.cwiseAbs2().asDiagonal()};
}

// A grid of positions about the keyframes, each once, at the height of the keyframe next to it.
std::vector<Eigen::Vector3d> places_about(std::span<const SE3> T_map_keyframes) {
  const int reach = static_cast<int>(kReachM / kStepM);
  std::set<std::array<int, 3>> taken;
  std::vector<Eigen::Vector3d> places;
  for (const SE3& T_map_base : T_map_keyframes) {
    const Eigen::Vector3d& p = T_map_base.translation();
    const int x = static_cast<int>(std::floor(p.x() / kStepM));
    const int y = static_cast<int>(std::floor(p.y() / kStepM));
    const int storey = static_cast<int>(std::lround(p.z()));
    for (int dx = -reach; dx <= reach; ++dx) {
      for (int dy = -reach; dy <= reach; ++dy) {
        if (dx * dx + dy * dy <= reach * reach && taken.insert({x + dx, y + dy, storey}).second) {
          places.emplace_back((x + dx + 0.5) * kStepM, (y + dy + 0.5) * kStepM, p.z());
        }
      }
    }
  }
  return places;
}

// Some of the points of walls, spread over all of them.
std::vector<Eigen::Vector3f> wall_points(const VoxelMap& sweep_base) {
  std::vector<Eigen::Vector3f> all;
  for (const OrientedPoint& point : sweep_base.select(kWallLevel).points) {
    if (std::abs(point.normal.z()) < kMaxUprightNormal) {
      all.push_back(point.p);
    }
  }
  const std::size_t stride = (all.size() + kMaxPoints - 1) / kMaxPoints;
  std::vector<Eigen::Vector3f> some;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    some.push_back(all[i]);
  }
  return some;
}

}  // namespace

PlaceSearch::WallCells::WallCells(const VoxelMap& map) {
  Eigen::AlignedBox3f box;
  for (const Voxel& voxel : map.level(kWallLevel).voxels()) {
    if (is_wall(voxel)) {
      box.extend(voxel.mean);
    }
  }
  if (box.isEmpty() || (box.sizes() / kCellM).cast<double>().prod() > kMaxCells) {
    return;
  }
  p_first = box.min().array() - 1.5F * kCellM;
  size = (box.sizes() / kCellM).cast<int>().array() + 4;
  near_wall.assign(static_cast<std::size_t>(size.prod()), 0);
  for (const Voxel& voxel : map.level(kWallLevel).voxels()) {
    if (!is_wall(voxel)) {
      continue;
    }
    const Eigen::Vector3i cell = ((voxel.mean - p_first) / kCellM).cast<int>();
    for (int z = cell.z() - 1; z <= cell.z() + 1; ++z) {
      for (int y = cell.y() - 1; y <= cell.y() + 1; ++y) {
        for (int x = cell.x() - 1; x <= cell.x() + 1; ++x) {
          near_wall[static_cast<std::size_t>((z * size.y() + y) * size.x() + x)] = 1;
        }
      }
    }
  }
}

bool PlaceSearch::WallCells::is_near_wall(const Eigen::Vector3f& p_map) const {
  const Eigen::Array3f at = (p_map - p_first).array() / kCellM;
  if ((at < 0.0F).any() || (at >= size.cast<float>().array()).any()) {
    return false;
  }
  const Eigen::Vector3i cell = at.cast<int>();
  return near_wall[static_cast<std::size_t>((cell.z() * size.y() + cell.y()) * size.x() +
                                            cell.x())] != 0;
}

PlaceSearch::PlaceSearch(const RegistrationParams& params, std::span<const SE3> T_map_keyframes,
                         const VoxelMap& map)
    : params_(params), cells_(map), places_(places_about(T_map_keyframes)) {}

StartsResult PlaceSearch::find(const VoxelMap& sweep_base, const VoxelMap& map) const {
  const std::vector<Eigen::Vector3f> walls_base = wall_points(sweep_base);
  if (walls_base.size() < kMinPoints) {
    return {};
  }
  VoxelMap sweep = sweep_base;
  sweep.hold();
  return register_from(best_starts(try_all(walls_base)), sweep, map, prior_at, params_);
}

// The poses at which most points are near a wall. Every fifth point says whether the others are
// worth a look.
std::vector<StartPose> PlaceSearch::try_all(std::span<const Eigen::Vector3f> walls_base) const {
  struct Candidate {
    int hits;
    int heading;
    std::size_t place;
  };
  std::vector<Candidate> candidates;
  std::vector<Eigen::Vector3f> turned(walls_base.size());
  for (int h = 0; h < kHeadings; ++h) {
    const Eigen::Matrix3f R = heading(h).cast<float>();
    std::ranges::transform(walls_base, turned.begin(),
                           [&R](const Eigen::Vector3f& p) -> Eigen::Vector3f { return R * p; });
    for (std::size_t place = 0; place < places_.size(); ++place) {
      const Eigen::Vector3f t = places_[place].cast<float>();
      const auto hits = [&](std::size_t stride) {
        int count = 0;
        for (std::size_t i = 0; i < turned.size(); i += stride) {
          count += cells_.is_near_wall(turned[i] + t) ? 1 : 0;
        }
        return count;
      };
      const auto least = [&](std::size_t stride) {
        return static_cast<int>(kLeastPart * static_cast<double>(turned.size() / stride));
      };
      if (hits(5) < least(5)) {
        continue;
      }
      if (const int all = hits(1); all >= least(1)) {
        candidates.push_back({all, h, place});
      }
    }
  }
  std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::hits);
  candidates.resize(std::min(candidates.size(), kMaxCandidates));
  std::vector<StartPose> tried;
  for (const Candidate& candidate : candidates) {
    SE3 T = SE3::Identity();
    T.linear() = heading(candidate.heading);
    T.translation() = places_[candidate.place];
    tried.push_back({T, static_cast<double>(candidate.hits)});
  }
  return tried;
}

}  // namespace nodmap::slam6d
