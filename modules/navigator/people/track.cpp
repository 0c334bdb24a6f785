// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/track.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::navigator {
namespace {

// A detection farther away than this is not of the track.
constexpr double kFarthestDetectionM = 1.0;
// A track moves if it was seen this often, for this long (more than one sweep), at this speed.
constexpr int kMinSightings = 4;
// A new track counts after this many scans, about half of a sweep's on a person.
constexpr int kMinOfNew = 3;
// It counts for this long, as does one that has stopped. What has not moved for longer is an
// obstacle of the local map by then, for which the robot must not wait for ever.
constexpr time::Duration kNewFor = 2s;
constexpr time::Duration kShortest = 150ms;
constexpr double kMinHeightM = 0.1;
// Least fraction of a detection in ever-free space: most of it, or, with a held laser, which
// measures it in each scan, as much as noise does not explain.
constexpr double kPartlyFree = 0.25;
constexpr double kMostlyFree = 0.6;
// A radius shrinks by this much per detection, because two people who touch are measured as one. A
// leg does not tell how wide its person is.
constexpr double kShrinksM = 0.005;
constexpr double kWalksMps = 0.25;
constexpr double kSigmas = 2.0;
// A slower track is stationary.
constexpr double kStandsMps = 0.15;
// Largest position error out of view. With a larger one the robot would not move at all. What is
// known is the line along which the person walks, and roughly when.
constexpr double kMaxUnseenSigmaM = 0.5;
// A track is in sight if it was seen in one of the last two sweeps.
constexpr time::Duration kInSight = 800ms;

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
      stationary_since_(stamp),
      laser_is_held_(laser_is_held),
      lowest_m_(detection.lowest_m),
      highest_m_(detection.highest_m),
      has_come_(detection.free_ratio >= kMostlyFree),
      has_two_legs_(detection.num_legs == 2) {
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
                            sigma_m(detection) * sigma_m(detection) * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 4, 2> K = covariance_.leftCols<2>() * S.inverse();
  state_ += K * (detection.p_odom - state_.head<2>());
  covariance_ -= K * covariance_.topRows<2>();
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  radius_m_ =
      std::max(radius_m_ - (is_one_of_two_legs(detection) ? 0.0 : kShrinksM), detection.radius_m);
  seen_at_ = stamp_;
  lowest_m_ = std::min(lowest_m_, detection.lowest_m);
  highest_m_ = std::max(highest_m_, detection.highest_m);
  num_contradictions_ = 0;
  has_come_ = has_come_ || detection.free_ratio >= (laser_is_held_ ? kPartlyFree : kMostlyFree);
  has_two_legs_ = has_two_legs_ || detection.num_legs == 2;
  ++num_sightings_;
  const double speed_mps = state_.tail<2>().norm();
  const double sigma_mps = worse_sigma(covariance_.bottomRightCorner<2, 2>());
  const bool is_known = has_come_ && num_sightings_ >= kMinSightings && has_legs() &&
                        seen_at_ - first_seen_ >= kShortest;
  moves_ = moves_ ? speed_mps > kStandsMps
                  : is_known && speed_mps > std::max(kWalksMps, kSigmas * sigma_mps);
  stationary_since_ = moves_ ? seen_at_ : stationary_since_;
}

// Whether it was measured over a range of heights, as a leg is by three or four lines of a sweep.
// A board or a seat is measured at one height. It, too, may appear in ever-free space, if lines
// have passed under and over it before, and seems to move with the line on it.
bool Track::has_legs() const {
  return laser_is_held_ || highest_m_ - lowest_m_ > kMinHeightM;
}

bool Track::is_new() const {
  return !moves_ && has_come_ && num_sightings_ >= kMinOfNew && has_legs() &&
         stamp_ - seen_at_ < kInSight && stamp_ - stationary_since_ < kNewFor;
}

double Track::distance_squared(const Detection& detection) const {
  const Eigen::Vector2d innovation = detection.p_odom - state_.head<2>();
  const Eigen::Matrix2d S = covariance_.topLeftCorner<2, 2>() +
                            sigma_m(detection) * sigma_m(detection) * Eigen::Matrix2d::Identity();
  return innovation.norm() > kFarthestDetectionM ? std::numeric_limits<double>::infinity()
                                                 : innovation.dot(S.inverse() * innovation);
}

Person Track::person() const {
  const double sigma_m = worse_sigma(covariance_.topLeftCorner<2, 2>());
  return {state_.head<2>(),
          state_.tail<2>(),
          radius_m_,
          hidden_at_ > seen_at_ ? std::min(kMaxUnseenSigmaM, sigma_m) : sigma_m,
          worse_sigma(covariance_.bottomRightCorner<2, 2>()),
          stamp_ - seen_at_ < kInSight,
          id_};
}

void Track::turn_round() {
  state_.tail<2>() *= -1.0;
  covariance_.topRightCorner<2, 2>() *= -1.0;
  covariance_.bottomLeftCorner<2, 2>() *= -1.0;
}

}  // namespace nodmap::navigator
