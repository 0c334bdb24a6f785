// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/mount_estimate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/registration/robust_kernel.hpp"

namespace nodmap::slam6d {
namespace {

// Where the floor is looked for: from the mirror, on the ground. Farther away a slope begins sooner
// than the wheels stand on it.
constexpr double kNearestM = 0.3;
constexpr double kFarthestM = 4.0;
// How far from z = 0 the floor may be there, for a mount that is off by 2 degrees.
constexpr double kHeightM = 0.03;
constexpr double kSlope = 0.045;
constexpr double kFirstScaleM = 0.05;
constexpr double kLastScaleM = 0.02;  // twice the laser's noise
constexpr int kFloorIterations = 8;
constexpr double kMinKernels = 150.0;
// By the kernel a floor with the laser's noise has 0.7; the rest is furniture, or a slope ahead.
constexpr double kMinFloorRatio = 0.5;
// A plane that is not determined to this, with this noise of points of which so many are as one, is
// of no use.
constexpr double kFloorSigmaRad = geometry::deg_to_rad(0.1);
constexpr double kFloorNoiseM = 0.01;
constexpr double kFloorCorrelation = 10.0;

// A point near the robot. Its z is what the three unknowns must explain: height, pitch and roll of
// the mount.
struct FloorPoint {
  Eigen::Vector3d by_unknowns;
  double z_m;
};

void append_floor(const scan::Scan& scan, scan::ScanProjector& projector,
                  std::vector<FloorPoint>& points) {
  const Eigen::Vector3d p_mirror =
      scan.T_base_mount * (geometry::pitch_rotation(scan.pitch_mid_rad()) * scan.mirror_offset_m);
  const double cos_pitch = std::cos(scan.pitch_mid_rad());
  for (const auto& hit : projector.hits(scan)) {
    const Eigen::Vector3d way = hit.p_base - p_mirror;
    const double distance_m = way.head<2>().norm();
    // A laser that looks higher than it should sees the floor farther away: it seems to lie lower.
    const Eigen::Vector3d by_unknowns(1.0, -way.x(), -cos_pitch * way.y());
    if (distance_m > kNearestM && distance_m < kFarthestM &&
        std::abs(hit.p_base.z()) < kHeightM + kSlope * distance_m) {
      points.push_back({by_unknowns, hit.p_base.z()});
    }
  }
}

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

std::optional<MountError> mount_error_by_floor(const PlacedSweep& sweep) {
  std::vector<FloorPoint> points;
  scan::ScanProjector projector;
  for (const PlacedSweep::PlacedScan& placed : sweep.scans) {
    append_floor(placed.scan, projector, points);
  }
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  double kernels = 0.0;
  for (int i = 0; i < kFloorIterations; ++i) {
    const double scale_m = i < kFloorIterations / 2 ? kFirstScaleM : kLastScaleM;
    H = 1e-6 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    kernels = 0.0;
    for (const FloorPoint& point : points) {
      const double relative = (point.z_m - point.by_unknowns.dot(x)) / scale_m;
      const double kernel = registration::geman_mcclure(relative * relative);
      H += kernel * point.by_unknowns * point.by_unknowns.transpose();
      g += kernel * point.z_m * point.by_unknowns;
      kernels += kernel;
    }
    x = H.ldlt().solve(g);
  }
  const Eigen::Vector3d variance =
      kFloorNoiseM * kFloorNoiseM * kFloorCorrelation * H.inverse().diagonal();
  if (kernels < kMinKernels || kernels < kMinFloorRatio * static_cast<double>(points.size()) ||
      !(variance.tail<2>().maxCoeff() < kFloorSigmaRad * kFloorSigmaRad)) {
    return std::nullopt;
  }
  return MountError{x[1], x[2]};
}

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
