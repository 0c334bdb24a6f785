// SPDX-License-Identifier: BSD-3-Clause
#include "tools/goal/route.hpp"

#include <utility>

namespace nodmap {

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
  reported_ = now;
  if (has_path || is_over_) {
    no_path_since_.reset();
    return Event::kNone;
  }
  no_path_since_ = no_path_since_.value_or(now);
  if (now - *no_path_since_ < patience_) {
    return Event::kNone;
  }
  ++num_missed_;
  ++missed_in_turn_;
  go_on();
  return Event::kMissed;
}

void Route::take_halt(time::SteadyTime now) {
  if (no_path_since_) {
    *no_path_since_ += now - reported_;
  }
  reported_ = now;
}

void Route::go_on() {
  const bool is_last = index_ + 1 == waypoints_map_.size();
  if (is_patrol_ ? missed_in_turn_ == waypoints_map_.size() : is_last) {
    is_over_ = true;
    return;
  }
  index_ = is_last ? 0 : index_ + 1;
  no_path_since_.reset();
}

}  // namespace nodmap
