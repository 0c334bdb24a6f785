// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/people_tracker.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// Largest squared Mahalanobis distance of a detection from its track, the 99 % quantile for two
// dimensions, and largest distance.
constexpr double kGate = 9.2;
constexpr double kFarthestM = 1.0;
// A track moves if it was seen this often, for this long (more than one sweep), at this speed.
constexpr int kFewestSightings = 4;
// A new track counts after this many scans, about half of a sweep's on a person.
constexpr int kFewestOfNew = 3;
constexpr time::Duration kShortest = 150ms;
constexpr double kLeastHeightM = 0.1;
// Least fraction of a detection in ever-free space: most of it, or, with a held laser, which
// measures it in each scan, as much as noise does not explain.
constexpr double kPartlyFree = 0.25;
constexpr double kMostlyFree = 0.6;
// A radius shrinks by this much per detection, because two people who touch are measured as one.
constexpr double kShrinksM = 0.005;
constexpr double kWalksMps = 0.25;
constexpr double kSigmas = 2.0;
// A slower track is stationary.
constexpr double kStandsMps = 0.15;
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
// Largest position error out of view. With a larger one the robot would not move at all. What is
// known is the line along which the person walks, and roughly when.
constexpr double kMostUnseenSigmaM = 0.5;
// A track is in sight if it was seen in one of the last two sweeps.
constexpr time::Duration kInSight = 800ms;
constexpr time::Duration kDouble = 200ms;
// This near to the laser a person may be below or beside its beams.
constexpr double kBlindRangeM = 0.5;
constexpr int kMostContradictions = 4;

double seconds_between(time::Timestamp from, time::Timestamp to) {
  return time::seconds(to - from);
}

double worse_sigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(std::max(
      0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly)
               .eigenvalues()
               .maxCoeff()));
}

}  // namespace

Track::Track(time::Timestamp stamp, const Detection& detection, std::int64_t id, bool laser_is_held)
    : id_(id),
      radius_m_(detection.radius_m),
      stamp_(stamp),
      first_seen_(stamp),
      seen_at_(stamp),
      laser_is_held_(laser_is_held),
      lowest_m_(detection.lowest_m),
      highest_m_(detection.highest_m),
      has_come_(detection.free_ratio >= kMostlyFree) {
  state_ << detection.p_odom, Eigen::Vector2d::Zero();
  const double p = kPositionSigmaM * kPositionSigmaM;
  const double v = kVelocitySigmaMps * kVelocitySigmaMps;
  covariance_ = Eigen::Vector4d(p, p, v, v).asDiagonal();
}

void Track::predict(time::Timestamp stamp) {
  const double dt = std::max(0.0, seconds_between(stamp_, stamp));
  stamp_ = std::max(stamp_, stamp);
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F.topRightCorner<2, 2>().diagonal().setConstant(dt);
  Eigen::Matrix4d Q = Eigen::Matrix4d::Zero();
  Q.topLeftCorner<2, 2>().diagonal().setConstant(dt * dt * dt / 3.0);
  Q.topRightCorner<2, 2>().diagonal().setConstant(0.5 * dt * dt);
  Q.bottomLeftCorner<2, 2>().diagonal().setConstant(0.5 * dt * dt);
  Q.bottomRightCorner<2, 2>().diagonal().setConstant(dt);
  state_ = F * state_;
  covariance_ = F * covariance_ * F.transpose() + kAccelerationDensity * Q;
}

void Track::update(const Detection& detection) {
  const Eigen::Matrix2d S = covariance_.topLeftCorner<2, 2>() +
                            kPositionSigmaM * kPositionSigmaM * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 4, 2> K = covariance_.leftCols<2>() * S.inverse();
  state_ += K * (detection.p_odom - state_.head<2>());
  covariance_ -= K * covariance_.topRows<2>();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  radius_m_ = std::max(radius_m_ - kShrinksM, detection.radius_m);
  seen_at_ = stamp_;
  lowest_m_ = std::min(lowest_m_, detection.lowest_m);
  highest_m_ = std::max(highest_m_, detection.highest_m);
  num_contradictions_ = 0;
  has_come_ = has_come_ || detection.free_ratio >= (laser_is_held_ ? kPartlyFree : kMostlyFree);
  ++num_sightings_;
  const double speed_mps = state_.tail<2>().norm();
  const double sigma_mps = worse_sigma(covariance_.bottomRightCorner<2, 2>());
  const bool is_known = has_come_ && num_sightings_ >= kFewestSightings && has_legs() &&
                        seen_at_ - first_seen_ >= kShortest;
  moves_ = moves_ ? speed_mps > kStandsMps
                  : is_known && speed_mps > std::max(kWalksMps, kSigmas * sigma_mps);
}

// Whether it was measured over a range of heights, as a leg is by three or four lines of a sweep.
// A board or a seat is measured at one height. It, too, may appear in ever-free space, if lines
// have passed under and over it before, and seems to move with the line on it.
bool Track::has_legs() const {
  return laser_is_held_ || highest_m_ - lowest_m_ > kLeastHeightM;
}

bool Track::is_new() const {
  return !moves_ && has_come_ && num_sightings_ >= kFewestOfNew && has_legs() &&
         stamp_ - seen_at_ < kInSight;
}

double Track::distance_squared(const Detection& detection) const {
  const Eigen::Vector2d innovation = detection.p_odom - state_.head<2>();
  const Eigen::Matrix2d S = covariance_.topLeftCorner<2, 2>() +
                            kPositionSigmaM * kPositionSigmaM * Eigen::Matrix2d::Identity();
  return innovation.norm() > kFarthestM ? std::numeric_limits<double>::infinity()
                                        : innovation.dot(S.inverse() * innovation);
}

Person Track::person() const {
  const double sigma_m = worse_sigma(covariance_.topLeftCorner<2, 2>());
  return {state_.head<2>(),
          state_.tail<2>(),
          radius_m_,
          hidden_at_ > seen_at_ ? std::min(kMostUnseenSigmaM, sigma_m) : sigma_m,
          worse_sigma(covariance_.bottomRightCorner<2, 2>()),
          stamp_ - seen_at_ < kInSight,
          id_};
}

void Track::turn_round() {
  state_.tail<2>() *= -1.0;
  covariance_.topRightCorner<2, 2>() *= -1.0;
  covariance_.bottomLeftCorner<2, 2>() *= -1.0;
}

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
  constexpr double kStepM = 0.05;
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const Eigen::Vector2d mount_base = scan.T_base_mount.translation().head<2>();
  const double half_span_rad =
      0.5 * static_cast<double>(scan.ranges_m.size() - 1) * scan.angle_step_rad;
  const double middle_rad = scan.angle_first_rad + half_span_rad;
  for (Track& track : tracks_) {
    const Person person = track.person();
    const Eigen::Vector2d p = T_base_odom * person.position - mount_base;
    const double from_middle_rad = geometry::angle_difference(std::atan2(p.y(), p.x()), middle_rad);
    // The beams of a laser that is mounted upside down are in clockwise order.
    const bool is_in_view = std::abs(from_middle_rad) < std::abs(half_span_rad);
    if (is_in_view && p.norm() > kBlindRangeM) {
      continue;
    }
    track.hide(scan.mid_stamp());
    const auto is_stopped = [&](double side) {
      const Eigen::Vector2d ahead = side * person.velocity.normalized();
      for (double d = person.radius_m + kOnTrackM; d <= kTurnsBeforeM; d += kStepM) {
        if (is_blocked(person.position + d * ahead)) {
          return true;
        }
      }
      return false;
    };
    // An obstacle at the track itself may be the person as last measured. Between two obstacles the
    // track goes on.
    if (is_blocked && is_stopped(1.0) && !is_stopped(-1.0)) {
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
           track.num_contradictions() > kMostContradictions;
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
