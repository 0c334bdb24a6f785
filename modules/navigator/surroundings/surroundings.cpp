// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/surroundings.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "modules/navigator/geofence.hpp"
#include "modules/navigator/people/wake.hpp"

namespace nodmap::navigator {
namespace {

// The robot waits for what approaches within this distance of its turning circle: a person at
// 1.5 m/s covers it in 0.4 s, and a rotation stops in 0.2 s. While driving the distance is longer
// by what the robot covers in the time that it needs to stop from 1.5 m/s.
constexpr double kWatchedM = 0.6;
constexpr double kWatchedS = 0.5;
// Doubtful ground counts up to this far beyond the turning circle, because arcs swing the rear
// out.
constexpr double kDoubtfulM = 0.1;
// For this long after somebody walked the obstacle map may still contain them.
constexpr time::Duration kPassed = 20s;

}  // namespace

Surroundings::Surroundings(const NavigatorParams& params)
    : params_(params),
      body_(params.robot.body.footprint()),
      local_map_(params.robot, params.local_map),
      rear_view_(params),
      seen_(params.steer),
      gap_(params.steer.sweeps_to_trust) {}

void Surroundings::add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                            bool laser_is_held) {
  // Nobody is tracked near ramps: while the robot tilts, things that stand still seem to move.
  const bool tracks_people = params_.people.use && local_map_.ground().is_level();
  if (tracks_people) {
    const auto is_blocked = [this](const Eigen::Vector2d& p_odom) {
      const LocalCell* cell = local_map_.cell_at(p_odom);
      return cell != nullptr && cell->is_obstacle();
    };
    people_.add_scan(scan, T_odom_base, is_blocked, laser_is_held);
  } else {
    people_.add_blind_scan(scan.mid_stamp());
  }
  if (params_.local_map.use) {
    local_map_.add_scan(scan, T_odom_base,
                        tracks_people ? people_.is_walker() : std::vector<bool>{});
    forget_wakes(people_.people_odom(scan.mid_stamp()), local_map_);
    for (const Contact& contact_odom : std::exchange(new_contacts_odom_, {})) {
      add_contact(contact_odom);
    }
  }
}

void Surroundings::add_contact(const Contact& contact_odom) {
  if (local_map_.has_scan()) {
    local_map_.add_contact(contact_odom.T_base, contact_odom.at_front);
  } else {
    new_contacts_odom_.push_back(contact_odom);
  }
}

void Surroundings::begin_anew() {
  const RearView rear_view = rear_view_;
  *this = Surroundings(params_);
  rear_view_ = rear_view;
}

void Surroundings::add_ranges(time::Timestamp stamp, const Proximity::Ranges& ranges_m,
                              const geometry::SE2& T_odom_base) {
  rear_view_.add(stamp, ranges_m, T_odom_base);
  if (params_.people.use && params_.local_map.use && local_map_.has_scan()) {
    proximity_.add(stamp, ranges_m, T_odom_base, local_map_, people_.people_odom(stamp));
  }
}

void Surroundings::forget_seen() {
  seen_.forget();
  gap_.reset();
}

void Surroundings::miss_scans() {
  if (gap_.begin()) {
    seen_.forget_unseen();
  } else {
    forget_seen();
  }
}

void Surroundings::complete(Situation& now) {
  seen_.update(now.T_odom_base.yaw, now.sweep_count);
  now.seen = &seen_;
  now.local_map = local_map_.has_scan() ? &local_map_ : nullptr;
  now.rear_view = &rear_view_;
  now.people = in_base(people_.people_odom(now.stamp), now.T_odom_base);
  slow_down(now);
  erase_floor(now);
  erase_people(now);
  add_local_map(now);
  add_standing(now);
  add_geofence(now);
}

void Surroundings::add_newcomers(Situation& now) const {
  if (params_.people.use) {
    const People newcomers = in_base(people_.newcomers_odom(now.stamp), now.T_odom_base);
    now.people.insert(now.people.end(), newcomers.begin(), newcomers.end());
  }
}

std::optional<Reason> Surroundings::reason_to_wait(time::Timestamp stamp) const {
  if (approach_.is_detected(stamp)) {
    return Why::kApproach;
  }
  if (proximity_.is_detected(stamp)) {
    return Why::kSomebodyClose;
  }
  return std::nullopt;
}

// Slows down after a gap in the scans, and near slopes. A laser that is held looks everywhere with
// the next scan.
void Surroundings::slow_down(Situation& now) {
  gap_.update(now.sweep_count);
  if (now.laser_is_held) {
    gap_.reset();
  }
  now.max_forward_mps *= gap_.speed_ratio();
  if (!local_map_.ground().is_level()) {
    now.max_forward_mps = std::min(now.max_forward_mps, params_.local_map.ground.sloped_mps);
  }
}

// Removes points of the obstacle map where the local map, made from the same scans, knows only
// floor. The obstacle map measures heights above the plane under the robot, so it takes
// sloped ground for obstacles; and it keeps people who have passed beside or behind the robot.
void Surroundings::erase_floor(Situation& now) {
  if (!now.people.empty()) {
    saw_people_at_ = now.stamp;
  }
  const bool have_passed = now.needs_seen_floor() && saw_people_at_ &&
                           std::chrono::abs(now.stamp - *saw_people_at_) < kPassed;
  if (have_passed || !local_map_.ground().is_level()) {
    std::erase_if(now.points_base, [&](const Eigen::Vector2d& p_base) {
      return local_map_.is_only_floor(now.T_odom_base * p_base);
    });
  }
}

// Removes points of the obstacle map that are people who walk, or that they have left behind.
// Watches what else approaches.
void Surroundings::erase_people(Situation& now) {
  Points points_of_things = without_wakes(now.people, now.points_base);
  watch_approach(now, points_of_things);
  if (now.local_map != nullptr) {
    // What has been beside a person for some seconds is also in the local map.
    now.points_base = std::move(points_of_things);
  }
}

void Surroundings::watch_approach(const Situation& now, const Points& points_base) {
  const double reach_m =
      body_.turning_radius_m() + kWatchedM + kWatchedS * std::max(0.0, now.forward_mps);
  approach_.update(now, reach_m, points_base);
}

// Adds the obstacles of the local map. Must follow watch_approach(): a low sill that is first seen
// when it is near has not approached.
void Surroundings::add_local_map(Situation& now) const {
  if (now.local_map == nullptr) {
    return;
  }
  const Points more = local_map_.points_base(now.T_odom_base, params_.local_map.range_m);
  now.points_base.insert(now.points_base.end(), more.begin(), more.end());
  if (now.needs_seen_floor()) {
    now.doubtful_base =
        local_map_.doubtful_points_base(now.T_odom_base, body_.turning_radius_m() + kDoubtfulM);
    now.unseen_ahead_base = local_map_.unseen_ahead_base(now.T_odom_base);
    now.possible_ramps_down_base =
        local_map_.possible_ramps_down_base(now.T_odom_base, longest_stop_m());
  }
}

// Adds what stands beside or behind the robot. Must follow what removes points.
void Surroundings::add_standing(Situation& now) const {
  const Points standing = proximity_.points_base(now.T_odom_base);
  now.points_base.insert(now.points_base.end(), standing.begin(), standing.end());
}

// Adds the boundary of the geofence. Must follow watch_approach(), because the boundary moves when
// the pose is corrected.
void Surroundings::add_geofence(Situation& now) const {
  if (now.geofence == nullptr) {
    return;
  }
  const double reach_m = params_.local_map.range_m + longest_stop_m();
  const geometry::SE2 T_map_base = now.T_map_base();
  const geometry::SE2 T_base_map = T_map_base.inverse();
  for (const auto& p_map : now.geofence->boundary_near(T_map_base.translation(), reach_m)) {
    now.points_base.push_back(T_base_map * p_map);
  }
}

// How far from base an obstacle must count, so that the robot stops before it from its fastest
// speed.
double Surroundings::longest_stop_m() const {
  return body_.turning_radius_m() + params_.robot.braking.required_distance_m(
                                        params_.drive.max_forward_mps, params_.drive.reaction_s);
}

}  // namespace nodmap::navigator
