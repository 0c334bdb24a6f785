// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/people_tracker.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// Largest squared Mahalanobis distance of a detection from its track: the 99 % quantile for two
// dimensions.
constexpr double kGate = 9.2;
// A beam that ends this near to a track's disc has hit it: the error of the track.
constexpr double kOnTrackM = 0.2;
constexpr double kFloorM = 0.03;
// A track ends after this long without a detection, or this many scans with beams through its
// middle.
constexpr time::Duration kLost = 1500ms;
// A track beside or behind the laser, where it cannot be detected, ends after this long: people
// who walk up and down a room of 8 m at 1 m/s are back by then.
constexpr time::Duration kUnseen = 12s;
// Out of view, a track turns round this far before a wall.
constexpr double kTurnsBeforeM = 0.6;
constexpr time::Duration kDouble = 200ms;
// This near to the laser a person may be below or beside its beams.
constexpr double kBlindRangeM = 0.5;
constexpr int kMaxContradictions = 4;

// Whether the laser sees this place at some pitch.
bool is_in_view(const Eigen::Vector2d& p_base, const scan::Scan& scan) {
  const Eigen::Vector2d p = p_base - scan.T_base_mount.translation().head<2>();
  const double half_span_rad =
      0.5 * static_cast<double>(scan.ranges_m.size() - 1) * scan.angle_step_rad;
  const double middle_rad = scan.angle_first_rad + half_span_rad;
  const double from_middle_rad = geometry::angle_difference(std::atan2(p.y(), p.x()), middle_rad);
  // The beams of a laser that is mounted upside down are in clockwise order.
  return std::abs(from_middle_rad) < std::abs(half_span_rad) && p.norm() > kBlindRangeM;
}

// Whether an obstacle will soon stop a person who walks in this direction. An obstacle at the
// person's own place does not count: it may be the person as last measured.
bool is_before_obstacle(const Person& person, const Eigen::Vector2d& direction,
                        const PeopleTracker::IsBlocked& is_blocked) {
  constexpr double kStepM = 0.05;
  const Eigen::Vector2d ahead = direction.normalized();
  for (double d = person.radius_m + kOnTrackM; d <= kTurnsBeforeM; d += kStepM) {
    if (is_blocked(person.position + d * ahead)) {
      return true;
    }
  }
  return false;
}

}  // namespace

void PeopleTracker::add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                             const IsBlocked& is_blocked, bool laser_is_held) {
  const std::vector<Detection> detections = detector_.add_scan(scan, T_odom_base, laser_is_held);
  const time::Timestamp stamp = scan.mid_stamp();
  is_walker_.assign(scan.ranges_m.size(), false);
  for (Track& track : tracks_) {
    track.predict(stamp);
  }
  associate(detections, stamp, laser_is_held);
  mark_walkers(scan, T_odom_base);
  follow_unseen(scan, T_odom_base, is_blocked);
  contradict_passed();
  drop_lost(stamp);
  drop_doubles(stamp);
}

void PeopleTracker::add_blind_scan(time::Timestamp stamp) {
  for (Track& track : tracks_) {
    track.predict(stamp);
  }
  drop_lost(stamp);
}

// Each detection goes to the nearest track by Mahalanobis distance; without one it begins a track.
void PeopleTracker::associate(const std::vector<Detection>& detections, time::Timestamp stamp,
                              bool laser_is_held) {
  const std::size_t num_known = tracks_.size();
  for (const Detection& detection : detections) {
    Track* nearest = nullptr;
    double least = kGate;
    for (std::size_t i = 0; i < num_known; ++i) {
      const double distance = tracks_[i].distance_squared(detection);
      if (distance < least) {
        least = distance;
        nearest = &tracks_[i];
      }
    }
    if (nearest != nullptr) {
      nearest->update(detection);
    } else {
      tracks_.emplace_back(stamp, detection, next_id_++, laser_is_held);
    }
  }
}

// Marks all beams that end on a moving track above the floor, at any height.
void PeopleTracker::mark_walkers(const scan::Scan& scan, const geometry::SE2& T_odom_base) {
  const People people = in_base(people_odom(scan.mid_stamp()), T_odom_base);
  for (std::size_t beam = 0; beam < scan.ranges_m.size() && !people.empty(); ++beam) {
    if (!scan.is_hit(beam)) {
      continue;
    }
    const Eigen::Vector3d p =
        scan::point_in_base(scan, beam, static_cast<double>(scan.ranges_m[beam]));
    is_walker_[beam] = p.z() > kFloorM && std::ranges::any_of(people, [&](const Person& person) {
                         return person.is_in_sight && (p.head<2>() - person.position).norm() <
                                                          person.radius_m + kOnTrackM;
                       });
  }
}

// Predicts tracks beside and behind the robot, where they cannot be detected.
void PeopleTracker::follow_unseen(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                                  const IsBlocked& is_blocked) {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  for (Track& track : tracks_) {
    const Person person = track.person();
    if (is_in_view(T_base_odom * person.position, scan)) {
      continue;
    }
    track.hide(scan.mid_stamp());
    // Between two obstacles the track goes on.
    if (is_blocked && is_before_obstacle(person, person.velocity, is_blocked) &&
        !is_before_obstacle(person, -person.velocity, is_blocked)) {
      track.turn_round();
    }
  }
}

// Beams have passed through the middle of a track.
void PeopleTracker::contradict_passed() {
  for (Track& track : tracks_) {
    if (detector_.space().is_passed_now(track.person().position)) {
      track.contradict();
    }
  }
}

void PeopleTracker::drop_lost(time::Timestamp stamp) {
  std::erase_if(tracks_, [&](const Track& track) {
    return std::chrono::abs(stamp - track.missed_since()) > kLost ||
           std::chrono::abs(stamp - track.seen_at()) > (track.moves() ? kUnseen : kLost) ||
           track.num_contradictions() > kMaxContradictions;
  });
}

template <class Select>
People PeopleTracker::select(time::Timestamp stamp, const Select& is_wanted) const {
  People people;
  for (Track track : tracks_) {
    track.predict(stamp);
    if (is_wanted(track)) {
      people.push_back(track.person());
    }
  }
  return people;
}

// Drops tracks that are no longer detected and lie on another one: they were the same person.
void PeopleTracker::drop_doubles(time::Timestamp stamp) {
  const People people = select(stamp, [&](const Track& track) { return track.seen_at() == stamp; });
  std::erase_if(tracks_, [&](const Track& track) {
    return stamp - track.seen_at() > kDouble &&
           std::ranges::any_of(people, [&](const Person& person) {
             return (person.position - track.person().position).norm() < person.radius_m;
           });
  });
}

People PeopleTracker::people_odom(time::Timestamp stamp) const {
  return select(stamp, [](const Track& track) { return track.moves(); });
}

People PeopleTracker::newcomers_odom(time::Timestamp stamp) const {
  return select(stamp, [](const Track& track) { return track.is_new(); });
}

bool PeopleTracker::is_anybody_near(const Eigen::Vector2d& p_odom, double distance_m,
                                    time::Timestamp stamp) const {
  return std::ranges::any_of(people_odom(stamp), [&](const Person& person) {
    return (person.position - p_odom).norm() < distance_m;
  });
}

People in_base(People people_odom, const geometry::SE2& T_odom_base) {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const Eigen::Matrix2d R_base_odom = T_base_odom.rotation();
  for (Person& person : people_odom) {
    person.position = T_base_odom * person.position;
    person.velocity = R_base_odom * person.velocity;
  }
  return people_odom;
}

}  // namespace nodmap::navigator
