// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/keyframe_grid.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::slam2d {
namespace {

// A ray may be longer than its neighbours by this factor, as it is on walls seen at a flat angle.
constexpr double kMaxLengthRatio = 1.5;

// Calls `visit` with both ends of each ray in map, and whether something was hit at the second.
template <typename Visit>
void for_each_ray(const Keyframe& keyframe, const geometry::SE2& T_map_base, Visit visit) {
  const std::vector<double> believed_m = believed_lengths(keyframe);
  const Eigen::Vector2d sensor_origin = T_map_base * keyframe.sensor_origin_base;
  const double c = std::cos(T_map_base.yaw);
  const double s = std::sin(T_map_base.yaw);
  for (std::size_t i = 0; i < believed_m.size(); ++i) {
    const Eigen::Vector2d ray =
        keyframe.points_base[i].cast<double>() - keyframe.sensor_origin_base;
    const double length_m = ray.norm();
    const bool is_whole = believed_m[i] >= length_m;
    const double ratio = is_whole ? 1.0 : believed_m[i] / length_m;
    const Eigen::Vector2d end_base = keyframe.sensor_origin_base + ratio * ray;
    const Eigen::Vector2d end(T_map_base.x + c * end_base.x() - s * end_base.y(),
                              T_map_base.y + s * end_base.x() + c * end_base.y());
    visit(sensor_origin, end, is_whole);
  }
}

// Whether points at a typical range move by more than `distance_m` between the two poses.
bool has_moved(const geometry::SE2& from, const geometry::SE2& to, double distance_m) {
  constexpr double kTypicalRangeM = 5.0;
  return geometry::distance_m(to, from) + kTypicalRangeM * geometry::rotation_rad(to, from) >
         distance_m;
}

}  // namespace

std::vector<double> believed_lengths(const Keyframe& keyframe) {
  const std::size_t count = keyframe.points_base.size();
  std::vector<double> lengths_m;
  for (const Eigen::Vector2f& point : keyframe.points_base) {
    lengths_m.push_back((point.cast<double>() - keyframe.sensor_origin_base).norm());
  }
  // Morphological opening: the shortest of every three neighbours, then for each ray the longest of
  // the triples that contain it.
  std::vector<double> opened_m(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double shortest_m = std::min({lengths_m[i - 1], lengths_m[i], lengths_m[i + 1]});
    for (std::size_t k = i - 1; k <= i + 1; ++k) {
      opened_m[k] = std::max(opened_m[k], shortest_m);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (lengths_m[i] > kMaxLengthRatio * opened_m[i]) {
      lengths_m[i] = opened_m[i];
    }
  }
  return lengths_m;
}

std::int64_t draw(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid,
                  std::span<const CellRange> left_out) {
  std::int64_t num_beyond = 0;
  for_each_ray(keyframe, T_map_base, [&](const auto& from, const auto& to, bool is_whole) {
    const bool is_drawn =
        is_whole ? grid.add_ray(from, to, left_out) : grid.add_free_ray(from, to, left_out);
    num_beyond += is_drawn ? 0 : 1;
  });
  return num_beyond;
}

void erase(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid,
           std::span<const CellRange> left_out) {
  for_each_ray(keyframe, T_map_base, [&](const auto& from, const auto& to, bool is_whole) {
    if (is_whole) {
      grid.remove_ray(from, to, left_out);
    } else {
      grid.remove_free_ray(from, to, left_out);
    }
  });
}

void KeyframeGrid::draw_new(std::span<const Keyframe> keyframes) {
  while (drawn_at_.size() < keyframes.size()) {
    const std::size_t k = drawn_at_.size();
    rays_beyond_ += draw(keyframes[k], keyframes[k].T_map_base, grid_, left_out(k));
    drawn_at_.push_back(keyframes[k].T_map_base);
  }
}

KeyframeGrid KeyframeGrid::snapshot() {
  KeyframeGrid copy(grid_.snapshot());
  copy.drawn_at_ = drawn_at_;
  copy.next_redrawn_ = next_redrawn_;
  copy.rays_beyond_ = rays_beyond_;
  copy.cleared_ = cleared_;
  return copy;
}

void KeyframeGrid::redraw_moved(std::span<const Keyframe> keyframes, std::size_t max_checked,
                                std::size_t max_drawn) {
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < std::min(max_checked, drawn_at_.size()) && drawn < max_drawn; ++i) {
    next_redrawn_ = (next_redrawn_ + 1) % drawn_at_.size();
    const geometry::SE2& T_map_base = keyframes[next_redrawn_].T_map_base;
    if (has_moved(drawn_at_[next_redrawn_], T_map_base, grid_.cell_size_m())) {
      redraw(keyframes, next_redrawn_);
      ++drawn;
    }
  }
}

void KeyframeGrid::redraw_all_moved(std::span<const Keyframe> keyframes) {
  for (std::size_t k = 0; k < drawn_at_.size(); ++k) {
    if (has_moved(drawn_at_[k], keyframes[k].T_map_base, 0.5 * grid_.cell_size_m())) {
      redraw(keyframes, k);
    }
  }
}

void KeyframeGrid::redraw(std::span<const Keyframe> keyframes, std::size_t keyframe) {
  const std::vector<CellRange> left_out = this->left_out(keyframe);
  erase(keyframes[keyframe], drawn_at_[keyframe], grid_, left_out);
  rays_beyond_ += draw(keyframes[keyframe], keyframes[keyframe].T_map_base, grid_, left_out);
  drawn_at_[keyframe] = keyframes[keyframe].T_map_base;
}

void KeyframeGrid::drop(const DroppedKeyframes& dropped) {
  const std::size_t end = dropped.first + dropped.keyframes.size();
  for (std::size_t k = dropped.first; k < end; ++k) {
    erase(dropped.keyframes[k - dropped.first], drawn_at_[k], grid_, left_out(k));
  }
  drawn_at_.erase(drawn_at_.begin() + static_cast<std::ptrdiff_t>(dropped.first),
                  drawn_at_.begin() + static_cast<std::ptrdiff_t>(end));
  for (ClearedRegion& cleared : cleared_) {
    cleared.num_keyframes -= std::clamp(cleared.num_keyframes, dropped.first, end) - dropped.first;
  }
  std::erase_if(cleared_, [](const ClearedRegion& cleared) { return cleared.num_keyframes == 0; });
}

// The keyframes drawn so far leave the region out from now on, both when they are drawn and when
// they are erased.
bool KeyframeGrid::clear(const Region& region) {
  const auto is_replaced = [&region](const ClearedRegion& cleared) {
    return contains(region, cleared.region);
  };
  if (cleared_.size() >= kMaxCleared && std::ranges::none_of(cleared_, is_replaced)) {
    return false;
  }
  std::erase_if(cleared_, is_replaced);
  grid_.clear(grid_.cells_of(region));
  if (!drawn_at_.empty()) {
    cleared_.push_back({region, drawn_at_.size()});
  }
  return true;
}

std::vector<CellRange> KeyframeGrid::left_out(std::size_t keyframe) const {
  std::vector<CellRange> cells;
  for (const ClearedRegion& cleared : cleared_) {
    if (keyframe < cleared.num_keyframes) {
      cells.push_back(grid_.cells_of(cleared.region));
    }
  }
  return cells;
}

}  // namespace nodmap::slam2d
