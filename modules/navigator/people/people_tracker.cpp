// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/people_tracker.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

/// 99 % of the detections of a track lie nearer.
constexpr double kGate = 9.2;
constexpr double kFarthestM = 1.0;
/// Evidence for a motion: seen so often, over so long (more than one sweep), and so fast.
constexpr int kFewestSightings = 4;
constexpr std::int64_t kShortestUs = 150'000;
constexpr double kLeastMps = 0.25;
constexpr double kSigmas = 2.0;
/// Slower than this a walker stands.
constexpr double kStandsMps = 0.15;
/// A track is kept so long without being seen, and so often with beams through its middle.
constexpr std::int64_t kLostUs = 1'500'000;
constexpr int kMostContradictions = 4;

double seconds_between(std::int64_t from_us, std::int64_t to_us) {
  return 1e-6 * static_cast<double>(to_us - from_us);
}

double worse_sigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(std::max(
      0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly)
               .eigenvalues()
               .maxCoeff()));
}

}  // namespace

Track::Track(std::int64_t utime_us, const Detection& detection)
    : radius_m_(detection.radius_m), utime_us_(utime_us), first_us_(utime_us), seen_us_(utime_us) {
  state_ << detection.p_odom, Eigen::Vector2d::Zero();
  const double p = kPositionSigmaM * kPositionSigmaM;
  const double v = kVelocitySigmaMps * kVelocitySigmaMps;
  covariance_ = Eigen::Vector4d(p, p, v, v).asDiagonal();
}

void Track::predict(std::int64_t utime_us) {
  const double dt = std::max(0.0, seconds_between(utime_us_, utime_us));
  utime_us_ = std::max(utime_us_, utime_us);
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
  radius_m_ = std::max(radius_m_, detection.radius_m);
  seen_us_ = utime_us_;
  num_contradictions_ = 0;
  ++num_sightings_;
  const double speed_mps = state_.tail<2>().norm();
  const double sigma_mps = worse_sigma(covariance_.bottomRightCorner<2, 2>());
  const bool is_known = num_sightings_ >= kFewestSightings && seen_us_ - first_us_ >= kShortestUs;
  moves_ = moves_ ? speed_mps > kStandsMps
                  : is_known && speed_mps > std::max(kLeastMps, kSigmas * sigma_mps);
}

double Track::distance_squared(const Detection& detection) const {
  const Eigen::Vector2d innovation = detection.p_odom - state_.head<2>();
  const Eigen::Matrix2d S = covariance_.topLeftCorner<2, 2>() +
                            kPositionSigmaM * kPositionSigmaM * Eigen::Matrix2d::Identity();
  return innovation.norm() > kFarthestM ? std::numeric_limits<double>::infinity()
                                        : innovation.dot(S.inverse() * innovation);
}

Person Track::person() const {
  return {state_.head<2>(), state_.tail<2>(), radius_m_,
          worse_sigma(covariance_.topLeftCorner<2, 2>()),
          worse_sigma(covariance_.bottomRightCorner<2, 2>())};
}

void PeopleTracker::add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base) {
  const std::vector<Detection> detections = detector_.add_scan(scan, T_odom_base);
  const std::int64_t utime_us = scan.utime_mid_us();
  is_walker_.assign(scan.ranges_m.size(), false);
  for (Track& track : tracks_) {
    track.predict(utime_us);
  }
  associate(detections, utime_us);
  drop_lost(utime_us);
}

/// Each detection goes to the track that expects it most; one that none expects begins a track.
void PeopleTracker::associate(const std::vector<Detection>& detections, std::int64_t utime_us) {
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
      std::fill(is_walker_.begin() + static_cast<std::ptrdiff_t>(detection.first_beam),
                is_walker_.begin() + static_cast<std::ptrdiff_t>(detection.last_beam) + 1,
                nearest->moves());
    } else {
      tracks_.emplace_back(utime_us, detection);
    }
  }
}

void PeopleTracker::drop_lost(std::int64_t utime_us) {
  for (Track& track : tracks_) {
    if (detector_.space().is_passed_now(track.person().position)) {
      track.contradict();
    }
  }
  std::erase_if(tracks_, [&](const Track& track) {
    return std::abs(utime_us - track.seen_us()) > kLostUs ||
           track.num_contradictions() > kMostContradictions;
  });
}

People PeopleTracker::people_odom(std::int64_t utime_us) const {
  People people;
  for (Track track : tracks_) {
    if (track.moves()) {
      track.predict(utime_us);
      people.push_back(track.person());
    }
  }
  return people;
}

People PeopleTracker::people_base(std::int64_t utime_us, const geometry::SE2& T_odom_base) const {
  People people = people_odom(utime_us);
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const Eigen::Matrix2d R_base_odom = T_base_odom.rotation();
  for (Person& person : people) {
    person.position = T_base_odom * person.position;
    person.velocity = R_base_odom * person.velocity;
  }
  return people;
}

}  // namespace nodmap::navigator
