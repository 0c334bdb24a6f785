// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/occupancy_mapper.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

namespace nodmap::slam6d {
namespace {

// How many scans after a keyframe its map is due, and one more for each cloud: 0.8 s at 75 Hz,
// before the next sweep.
constexpr int kScansUntilMapped = 60;
// A map that has not changed is handed out again after this many periods.
constexpr double kPeriodsUntilRepeated = 12.0;
// The file is written as a whole. As it is written only when it has grown by this much, all that is
// written is about eleven times as large as the last file, however large the map becomes.
constexpr std::size_t kSavedGrowthPercent = 10;
// To save a keyframe, 174 kB, takes 3 ms.
constexpr std::size_t kSavedKeyframesPerScan = 4;

// How many keyframes there were so far, those that were dropped included.
std::size_t number_of(std::span<const Keyframe> keyframes) {
  return keyframes.empty() ? 0 : keyframes.back().id + 1;
}

}  // namespace

OccupancyMapper::OccupancyMapper(const OccupancyParams& params, node::ResultsUsed results_used)
    : params_(params), map_(params.trace), work_(results_used) {}

// Keyframes that newer ones have replaced. Both are in the order of their ids.
void OccupancyMapper::forget_dropped(std::span<const Keyframe> keyframes) {
  auto keyframe = keyframes.begin();
  std::erase_if(mapped_, [&](const Mapped& mapped) {
    keyframe = std::ranges::lower_bound(keyframe, keyframes.end(), mapped.id, {}, &Keyframe::id);
    return keyframe == keyframes.end() || keyframe->id != mapped.id;
  });
}

bool OccupancyMapper::has_changed(std::span<const Keyframe> keyframes, double min_motion_m) const {
  for (std::size_t k = 0; k < mapped_.size(); ++k) {
    const double motion_m = motion_of_points_m(mapped_[k].T_map_base, keyframes[k].T_map_base,
                                               params_.trace.max_range_m);
    if (motion_m > min_motion_m || keyframes[k].cloud != mapped_[k].cloud ||
        keyframes[k].is_moved != mapped_[k].is_moved) {
      return true;
    }
  }
  return false;
}

void OccupancyMapper::update(std::span<const Keyframe> keyframes, time::Timestamp now,
                             double min_motion_m, const std::function<Save()>& prepare_save) {
  if (is_working() || keyframes.empty()) {
    return;
  }
  forget_dropped(keyframes);
  Work work;
  work.begins_anew = mapped_.empty() || has_changed(keyframes, min_motion_m);
  if (work.begins_anew) {
    mapped_.clear();
  }
  const std::span<const Keyframe> added = keyframes.subspan(mapped_.size());
  has_changed_since_ = has_changed_since_ || !added.empty();
  work.is_published = begin_publishing(now);
  if (added.empty() && !work.is_published) {
    return;
  }
  if (prepare_save && is_save_due(number_of(keyframes))) {
    work.save = prepare_save();
    num_saved_ = number_of(keyframes);
  }
  for (const Keyframe& keyframe : added) {
    mapped_.push_back({keyframe.id, keyframe.cloud, keyframe.T_map_base, keyframe.is_moved});
    work.keyframes.push_back(mapped_.back());
  }
  const std::size_t more_scans =
      added.size() + (work.save ? keyframes.size() / kSavedKeyframesPerScan : 0);
  work_.start([this, work = std::move(work)] { return execute(work); },
              kScansUntilMapped + static_cast<int>(more_scans));
}

bool OccupancyMapper::is_save_due(std::size_t num_keyframes) const {
  const auto every = static_cast<std::size_t>(params_.save_every_keyframes);
  return every > 0 &&
         num_keyframes >= num_saved_ + std::max(every, num_saved_ * kSavedGrowthPercent / 100);
}

OccupancyMapper::Result OccupancyMapper::execute(const Work& work) {
  if (work.begins_anew) {
    map_ = OccupancyMap(params_.trace);
  }
  for (const Mapped& keyframe : work.keyframes) {
    map_.insert(*keyframe.cloud, keyframe.T_map_base, keyframe.is_moved);
  }
  Result result;
  if (work.is_published) {
    result.bt_file = map_.encode(OccupancyMap::Format::kBt);
  }
  if (work.save) {
    result.save_error = work.save(map_);
  }
  return result;
}

void OccupancyMapper::save(const Save& save) {
  work_.start([this, save] { return Result{.save_error = save(map_)}; },
              kScansUntilMapped + static_cast<int>(mapped_.size() / kSavedKeyframesPerScan));
}

std::optional<std::error_code> OccupancyMapper::count_message() {
  return handle(work_.count_message());
}

std::optional<std::error_code> OccupancyMapper::take_early() {
  return handle(work_.take_early());
}

std::optional<std::error_code> OccupancyMapper::take() {
  return handle(work_.take());
}

std::optional<std::error_code> OccupancyMapper::handle(const std::optional<Result>& result) {
  if (!result) {
    return std::nullopt;
  }
  if (result->bt_file) {
    parts_.begin(newest_stamp(), *result->bt_file);
  }
  return result->save_error;
}

// Returns whether the map is to be handed out now.
bool OccupancyMapper::begin_publishing(time::Timestamp now) {
  if (params_.publish_period_s <= 0.0 || !parts_.is_empty()) {
    return false;
  }
  const double period_s =
      (has_changed_since_ ? 1.0 : kPeriodsUntilRepeated) * params_.publish_period_s;
  // A clock set back must not silence it until it has caught up.
  if (published_at_ && now >= *published_at_ && time::seconds(now - *published_at_) < period_s) {
    return false;
  }
  published_at_ = now;
  has_changed_since_ = false;
  return true;
}

std::optional<OctomapParts::Part> OccupancyMapper::next_part() {
  return parts_.is_empty() ? std::nullopt : std::optional(parts_.next());
}

void OccupancyMapper::publish_last() {
  if (params_.publish_period_s <= 0.0 || !has_changed_since_) {
    return;
  }
  if (const auto bt_file = map_.encode(OccupancyMap::Format::kBt)) {
    parts_.begin(newest_stamp(), *bt_file);
  }
}

// Of the measurements in the map.
time::Timestamp OccupancyMapper::newest_stamp() const {
  return mapped_.back().cloud->stamp;
}

}  // namespace nodmap::slam6d
