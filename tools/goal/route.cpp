// SPDX-License-Identifier: BSD-3-Clause
#include "tools/goal/route.hpp"

#include <utility>

namespace nodmap {
namespace {

// Between two reports that are farther apart than this the navigator was silent.
constexpr time::Duration kSilence = 1s;

}  // namespace

Route::Route(std::vector<Eigen::Vector2d> waypoints_map, bool is_patrol, time::Duration patience)
    : waypoints_map_(std::move(waypoints_map)), is_patrol_(is_patrol), patience_(patience) {}

Route::Event Route::take_arrival(bool has_arrived) {
  if (!has_arrived || is_over_) {
    return Event::kNone;
  }
  missed_in_turn_ = 0;
  go_on();
  return Event::kReached;
}

Route::Event Route::take_path(bool has_path, time::SteadyTime now) {
  if (has_path || is_over_) {
    forget_no_path();
    return Event::kNone;
  }
  const time::Duration since = now - std::exchange(no_path_at_, now).value_or(now);
  if (since <= kSilence) {
    without_path_ += since;
  }
  if (without_path_ < patience_) {
    return Event::kNone;
  }
  ++num_missed_;
  ++missed_in_turn_;
  go_on();
  return Event::kMissed;
}

void Route::go_on() {
  const bool is_last = index_ + 1 == waypoints_map_.size();
  if (is_patrol_ ? missed_in_turn_ == waypoints_map_.size() : is_last) {
    is_over_ = true;
    return;
  }
  index_ = is_last ? 0 : index_ + 1;
  forget_no_path();
}

void Route::forget_no_path() {
  no_path_at_.reset();
  without_path_ = {};
}

}  // namespace nodmap
