// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/ever_free_space.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <functional>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "common/geometry/angle.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// From map to the frame of the voxels. The ground on which the robot starts, at height 0, lies in
// the middle of a layer of voxels. On the border between two layers its noise would reach both, and
// feet would be taken for ground up to 14 cm instead of 11.
SE3 T_voxels_map(const EverFreeParams& params) {
  SE3 T = SE3::Identity();
  T.translation().z() = 0.5 * params.voxel_size_m;
  return T;
}

// With fewer votes, one sweep whose pose is a few centimetres off would remove floors.
constexpr int kMinVotes = 10;

constexpr VoxelCode kInCube = (VoxelCode{1} << 3U * CloudVoxels::kLevels) - 1;

// The coordinate of one axis: every third bit of a code.
std::uint16_t compact_bits(VoxelCode code) {
  code &= 0x249249249249ULL;
  code = (code | code >> 2U) & 0x0C30C30C30C3ULL;
  code = (code | code >> 4U) & 0x00F00F00F00FULL;
  code = (code | code >> 8U) & 0x0000FF0000FFULL;
  return static_cast<std::uint16_t>(code | code >> 16U);
}

VoxelKey key_of(VoxelCode code) {
  return {compact_bits(code), compact_bits(code >> 1U), compact_bits(code >> 2U)};
}

template <class Use>
void for_each_key(const VoxelKey& first, const VoxelKey& last, const Use& use) {
  for (std::uint32_t z = first[2]; z <= last[2]; ++z) {
    for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
      for (std::uint32_t x = first[0]; x <= last[0]; ++x) {
        use({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
             static_cast<std::uint16_t>(z)});
      }
    }
  }
}

// Whether `is_looked_for` is true for a voxel or for one of the 26 beside it.
template <class IsLookedFor>
bool has_beside(const VoxelKey& key, const IsLookedFor& is_looked_for) {
  return std::ranges::any_of(neighbourhood_of(key), is_looked_for);
}

// Of the points in each voxel: how many there are, and how many of them have moved.
class MovedCounts {
 public:
  void add(VoxelCode voxel, bool is_moved) {
    Counts& here = counts_[voxel];
    here.moved += is_moved ? 1 : 0;
    ++here.all;
  }

  void add_moved(const VoxelKey& key) { ++counts_[code_of(key)].moved; }

  // Whether at least a quarter of the points in a voxel and beside it have moved.
  [[nodiscard]] bool have_many_moved(const VoxelKey& key) const {
    constexpr int kOneOf = 4;
    Counts sum;
    has_beside(key, [&](VoxelCode voxel) {
      if (const auto found = counts_.find(voxel); found != counts_.end()) {
        sum.moved += found->second.moved;
        sum.all += found->second.all;
      }
      return false;
    });
    return sum.moved * kOneOf >= sum.all;
  }

 private:
  struct Counts {
    int moved = 0;
    int all = 0;
  };
  std::unordered_map<VoxelCode, Counts> counts_;
};

// The blocks of 4 x 4 x 4 voxels in which points moved, and those beside them: all that is within 4
// voxels of such a point, and some beyond.
class NearMoved {
 public:
  static constexpr unsigned kLevels = 2;  // of an octree within a block

  // `points`: with their keys.
  template <class Points>
  NearMoved(const Points& points, const std::vector<bool>& is_moved) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (is_moved[i]) {
        add(*points[i].key);
      }
    }
  }

  [[nodiscard]] bool contains(VoxelCode voxel) const {
    return blocks_.contains(voxel >> 3U * kLevels);
  }

 private:
  void add(const VoxelKey& key) {
    VoxelKey block = key;
    for (std::uint16_t& place : block) {
      place = static_cast<std::uint16_t>(place >> kLevels);
    }
    const auto near = neighbourhood_of(block);
    blocks_.insert(near.begin(), near.end());
  }

  std::unordered_set<VoxelCode> blocks_;
};

// Calls `use` with the place of each bit that is set, the lowest first.
template <class Use>
void for_each_bit(std::uint64_t bits, const Use& use) {
  for (; bits != 0U; bits &= bits - 1) {
    use(static_cast<std::size_t>(std::countr_zero(bits)));
  }
}

}  // namespace

// Both are halved before they overflow, because only their ratio matters.
void EverFreeSpace::Votes::add(int more_through, int more_hits) {
  int sum_through = through + more_through;
  int sum_hits = hits + more_hits;
  while (std::max(sum_through, sum_hits) > 255) {
    sum_through /= 2;
    sum_hits = (sum_hits + 1) / 2;
  }
  through = static_cast<std::uint8_t>(sum_through);
  hits = static_cast<std::uint8_t>(sum_hits);
}

EverFreeSpace::EverFreeSpace(const EverFreeParams& params)
    : params_(params),
      tracer_({.resolution_m = params.voxel_size_m,
               .max_range_m = params.max_range_m,
               .walk_once = true}) {}

void EverFreeSpace::add_sweep(const SweepCloud& cloud, const SE3& T_map_base, std::size_t keyframe,
                              int num_votes) {
  if (!params_.remove_moved) {
    return;
  }
  const SE3 T_voxels_base = T_voxels_map(params_) * T_map_base;
  if (keyframe == T_voxels_keyframes_.size()) {
    T_voxels_keyframes_.push_back(T_voxels_base);
  }
  num_votes_ = std::min(num_votes_ + num_votes, kMinVotes);
  if (num_votes_ < kMinVotes) {
    waiting_.push_back({cloud, T_voxels_base, keyframe, num_votes});
    return;
  }
  for (const Voter& voter : std::exchange(waiting_, {})) {
    count_votes(voter.cloud, voter.T_voxels_base, voter.keyframe, voter.num_votes);
  }
  count_votes(cloud, T_voxels_base, keyframe, num_votes);
}

void EverFreeSpace::count_votes(const SweepCloud& cloud, const SE3& T_voxels_base,
                                std::size_t keyframe, int num_votes) {
  of_sweep_.clear();
  tracer_.trace(cloud, T_voxels_base, of_sweep_);
  tracer_.trace_free(cloud, T_voxels_base, of_sweep_);
  for (const auto& seen : of_sweep_.cubes()) {
    Cube& cube = cubes_[seen->code];
    cube.keyframe = keyframe;
    cube.add(*seen, num_votes);
  }
}

// A voxel in which a beam ended counts as a hit, even if others passed through.
void EverFreeSpace::Cube::add(const CloudVoxels::Cube& of_sweep, int num_votes) {
  for (std::size_t word = 0; word < CloudVoxels::kWords; ++word) {
    const std::span<Votes> in_word =
        std::span(votes).subspan(word * CloudVoxels::kBitsPerWord, CloudVoxels::kBitsPerWord);
    const std::uint64_t hits = of_sweep.occupied[word];
    const std::uint64_t through = of_sweep.free[word] & ~hits;
    for_each_bit(through, [&](std::size_t bit) { in_word[bit].add(num_votes, 0); });
    for_each_bit(hits, [&](std::size_t bit) { in_word[bit].add(0, num_votes); });
  }
}

void EverFreeSpace::move_keyframes(std::span<const SE3> T_map_keyframes) {
  std::vector<SE3> T_new_old(T_voxels_keyframes_.size(), SE3::Identity());
  std::vector<bool> is_far(T_voxels_keyframes_.size());
  for (std::size_t k = 0; k < T_voxels_keyframes_.size(); ++k) {
    const SE3 T_voxels_keyframe = T_voxels_map(params_) * T_map_keyframes[k];
    is_far[k] = motion_of_points_m(T_voxels_keyframes_[k], T_voxels_keyframe, params_.max_range_m) >
                0.5 * params_.voxel_size_m;
    if (is_far[k]) {
      T_new_old[k] = T_voxels_keyframe * T_voxels_keyframes_[k].inverse();
      T_voxels_keyframes_[k] = T_voxels_keyframe;
    }
  }
  if (std::ranges::none_of(is_far, std::identity())) {
    return;
  }
  for (Voter& voter : waiting_) {
    voter.T_voxels_base = T_new_old[voter.keyframe] * voter.T_voxels_base;
  }
  Cubes moved;
  for (const auto& [code, cube] : cubes_) {
    move(cube, code, T_new_old[cube.keyframe], moved);
  }
  cubes_ = std::move(moved);
}

void EverFreeSpace::drop_keyframe(const ReplacedKeyframe& replaced) {
  if (replaced.index >= T_voxels_keyframes_.size()) {
    return;  // no keyframe has voted
  }
  T_voxels_keyframes_.erase(T_voxels_keyframes_.begin() +
                            static_cast<std::ptrdiff_t>(replaced.index));
  for (auto& [code, cube] : cubes_) {
    cube.keyframe = replaced.renumbered(cube.keyframe);
  }
  for (Voter& voter : waiting_) {
    voter.keyframe = replaced.renumbered(voter.keyframe);
  }
}

// Goes through the voxels of the new place. Each takes the votes from where it was, so that no
// voxel is left without votes.
void EverFreeSpace::move(const Cube& cube, VoxelCode code, const SE3& T_new_old,
                         Cubes& moved) const {
  const OctreeGrid& grid = tracer_.grid();
  const Eigen::Isometry3f to_new = T_new_old.cast<float>();
  const Eigen::Isometry3f to_old = to_new.inverse();
  const VoxelKey first = key_of(code << 3U * CloudVoxels::kLevels);
  const float edge_m =
      static_cast<float>(grid.resolution_m()) * static_cast<float>(1U << CloudVoxels::kLevels);
  const Eigen::Vector3f corner = grid.center_of(first);
  Eigen::AlignedBox3f box;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3i along(i & 1, (i >> 1) & 1, i >> 2);
    box.extend(to_new * (corner + edge_m * along.cast<float>()));
  }
  const auto begin = grid.key_of(box.min());
  const auto end = grid.key_of(box.max());
  if (!begin || !end) {
    return;
  }
  for_each_key(*begin, *end, [&](const VoxelKey& key) {
    const auto old_key = grid.key_of(to_old * grid.center_of(key));
    const VoxelCode old_voxel = old_key ? code_of(*old_key) : 0;
    if (!old_key || old_voxel >> 3U * CloudVoxels::kLevels != code) {
      return;
    }
    const Votes& votes = cube.votes[old_voxel & kInCube];
    if (votes.through != 0 || votes.hits != 0) {
      const VoxelCode voxel = code_of(key);
      Cube& target = moved[voxel >> 3U * CloudVoxels::kLevels];
      target.keyframe = std::max(target.keyframe, cube.keyframe);
      target.votes[voxel & kInCube].add(votes.through, votes.hits);
    }
  });
}

std::vector<bool> EverFreeSpace::moved_points(const SweepCloud& cloud, std::size_t keyframe) const {
  if (keyframe >= T_voxels_keyframes_.size() || num_votes_ < kMinVotes) {
    return {};
  }
  std::vector<PlacedPoint> points;
  points.reserve(cloud.points.size());
  std::vector<bool> is_moved;
  is_moved.reserve(cloud.points.size());
  Lookup lookup(cubes_);
  for (const Eigen::Vector3f& p : cloud.points) {
    const auto key =
        tracer_.grid().key_of((T_voxels_keyframes_[keyframe] * p.cast<double>()).cast<float>());
    points.push_back({key, key ? lookup.find(code_of(*key)) : nullptr});
    is_moved.push_back(key && is_ever_free(points.back(), lookup));
  }
  if (std::ranges::find(is_moved, true) != is_moved.end()) {
    add_rest(points, is_moved);
  }
  return is_moved;
}

// No beam passed close enough to these points to show their voxels empty. They are those with
// nothing certain beside them, of whose neighbours many have moved. Points in certain voxels,
// nearly all, are beside none of them and need not be counted; nor do points far from all that
// moved.
void EverFreeSpace::add_rest(std::span<const PlacedPoint> points,
                             std::vector<bool>& is_moved) const {
  constexpr int kSteps = 3;  // each reaches one voxel farther, and counts what is beside it
  static_assert(kSteps + 1 <= 1 << NearMoved::kLevels);
  const NearMoved near_moved(points, is_moved);
  Lookup lookup(cubes_);
  MovedCounts counts;
  std::vector<std::size_t> uncertain;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].key || is_certain(points[i].votes)) {
      continue;
    }
    const VoxelCode voxel = code_of(*points[i].key);
    if (!near_moved.contains(voxel)) {
      continue;
    }
    counts.add(voxel, is_moved[i]);
    if (!is_moved[i] && is_uncertain(points[i], lookup)) {
      uncertain.push_back(i);
    }
  }
  for (int step = 0; step < kSteps; ++step) {
    std::vector<std::size_t> rest;
    std::ranges::copy_if(uncertain, std::back_inserter(rest), [&](std::size_t i) {
      return !is_moved[i] && counts.have_many_moved(*points[i].key);
    });
    if (rest.empty()) {
      break;
    }
    for (const std::size_t i : rest) {
      is_moved[i] = true;
      counts.add_moved(*points[i].key);
    }
  }
}

bool EverFreeSpace::is_ever_free(const PlacedPoint& point, Lookup& lookup) const {
  return is_empty(point.votes) &&
         !has_beside(*point.key, [&](VoxelCode voxel) { return !is_empty(lookup.find(voxel)); });
}

bool EverFreeSpace::is_uncertain(const PlacedPoint& point, Lookup& lookup) const {
  return is_passing(point.votes) &&
         !has_beside(*point.key, [&](VoxelCode voxel) { return is_certain(lookup.find(voxel)); });
}

bool EverFreeSpace::is_certain(const Votes* votes) const {
  return !is_passing(votes) && !is_empty(votes);
}

bool EverFreeSpace::is_passing(const Votes* votes) const {
  return votes == nullptr || votes->hits <= params_.passing_hits;
}

bool EverFreeSpace::is_empty(const Votes* votes) const {
  return votes != nullptr && votes->through > 0 &&
         votes->through >= params_.through_per_hit * (votes->hits - params_.passing_hits);
}

const EverFreeSpace::Votes* EverFreeSpace::Lookup::find(VoxelCode voxel) {
  if (const VoxelCode code = voxel >> 3U * CloudVoxels::kLevels; code != code_) {
    const auto found = cubes_.find(code);
    code_ = code;
    cube_ = found == cubes_.end() ? nullptr : &found->second;
  }
  return cube_ == nullptr ? nullptr : &cube_->votes[voxel & kInCube];
}

std::size_t EverFreeSpace::memory_bytes() const {
  std::size_t bytes =
      cubes_.size() * sizeof(Cubes::value_type) + of_sweep_.memory_bytes() + tracer_.memory_bytes();
  for (const Voter& voter : waiting_) {
    bytes += (voter.cloud.points.size() + voter.cloud.free_points.size()) * sizeof(Eigen::Vector3f);
  }
  return bytes;
}

}  // namespace nodmap::slam6d
