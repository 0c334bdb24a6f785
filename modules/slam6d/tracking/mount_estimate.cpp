// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/mount_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "modules/slam6d/tracking/near_floor.hpp"

namespace nodmap::slam6d {
namespace {

constexpr std::size_t kMinFloors = 8;
constexpr std::size_t kMaxFloors = 200;  // the mount does not change
// Beyond this distance the ground is another.
constexpr double kOtherGroundM = 0.2;
// The ground is uneven by this at least, even if few sweeps agree better.
constexpr double kEvenGroundRad = geometry::deg_to_rad(0.3);
constexpr double kMedianSigmas = 4.0;
// What is corrected is changed only by more than this: 2 mm for each metre.
constexpr double kChangeRad = geometry::deg_to_rad(0.1);

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The standard deviation of the median of these samples. By the mean of squares: by the median of
// the deviations a few sweeps on rough ground agree by chance, and outliers should delay a belief.
double sigma_of_median(const std::vector<double>& values, double median) {
  constexpr double kMedianByMean = 1.2533;  // the median's to the mean's
  double sum_sq = 0.0;
  for (const double value : values) {
    sum_sq += (value - median) * (value - median);
  }
  const auto num = static_cast<double>(values.size());
  return kMedianByMean * std::max(kEvenGroundRad, std::sqrt(sum_sq / num)) / std::sqrt(num);
}

double largest(const MountError& error) {
  return std::max(std::abs(error.pitch_rad), std::abs(error.roll_rad));
}

}  // namespace

void MountEstimate::learn(const PlacedSweep& sweep) {
  if (num_sweeps() >= kMaxFloors ||
      (T_odom_last_ && geometry::distance_m(*T_odom_last_, sweep.T_odom_base) < kOtherGroundM)) {
    return;
  }
  if (const auto by_floor = mount_error_by_floor(sweep)) {
    T_odom_last_ = sweep.T_odom_base;
    learn(*by_floor);
  }
}

void MountEstimate::learn(const MountError& by_floor) {
  pitch_rad_.push_back(by_floor.pitch_rad);
  roll_rad_.push_back(by_floor.roll_rad);
  median_ = {.pitch_rad = median_of(pitch_rad_), .roll_rad = median_of(roll_rad_)};
  sigma_ = {.pitch_rad = sigma_of_median(pitch_rad_, median_.pitch_rad),
            .roll_rad = sigma_of_median(roll_rad_, median_.roll_rad)};
  const auto believed = [this](double median, double sigma) {
    const double least = std::max(params_.min_error_rad, kMedianSigmas * sigma);
    return num_sweeps() >= kMinFloors && std::abs(median) > least ? median : 0.0;
  };
  believed_ = {.pitch_rad = believed(median_.pitch_rad, sigma_.pitch_rad),
               .roll_rad = believed(median_.roll_rad, sigma_.roll_rad)};
}

bool MountEstimate::is_too_large() const {
  return largest(believed_) > params_.max_error_rad;
}

MountError MountEstimate::error() const {
  return params_.use && !is_too_large() ? believed_ : MountError{};
}

bool MountEstimate::is_corrected_anew(const MountError& corrected) const {
  const MountError wanted = error();
  return largest({.pitch_rad = wanted.pitch_rad - corrected.pitch_rad,
                  .roll_rad = wanted.roll_rad - corrected.roll_rad}) > kChangeRad;
}

}  // namespace nodmap::slam6d
