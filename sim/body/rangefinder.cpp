// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/rangefinder.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

struct Offset {
  double left;
  double up;
};

// Positions of the rays in a spot of radius 1. The central one represents a fifth of the area; the
// others are at the root mean square radius of the rest, sqrt((0.2 + 1) / 2).
constexpr double kRing = 0.7746;
constexpr std::array<Offset, Rangefinder::kRays> kPattern{
    {{0.0, 0.0}, {kRing, 0.0}, {-kRing, 0.0}, {0.0, kRing}, {0.0, -kRing}}};
constexpr double kRayFraction = 1.0 / Rangefinder::kRays;
// Up to this distance a white surface counts as returning all of the light.
constexpr double kNearM = 1.0;

}  // namespace

Echo Rangefinder::measure(const RayCaster& caster, const geometry::SE3& T_world_laser,
                          double angle_rad, std::span<const ActorState> actors) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const Eigen::Matrix3d& axes = T_world_laser.linear();
  const Eigen::Vector3d ahead = c * axes.col(0) + s * axes.col(1);
  const Eigen::Vector3d left = c * axes.col(1) - s * axes.col(0);
  const double radius_m = 0.5 * params_.spot_diameter_m;
  const double spread = std::tan(0.5 * params_.divergence_rad);
  std::array<Return, kRays> returns;
  for (std::size_t i = 0; i < kRays; ++i) {
    const Eigen::Vector3d aside = kPattern[i].left * left + kPattern[i].up * axes.col(2);
    const Ray ray{T_world_laser.translation() + radius_m * aside,
                  (ahead + spread * aside).normalized()};
    const std::optional<Hit> hit = caster.cast(ray, params_.max_range_m, actors);
    if (hit) {
      returns[i] = {hit->distance_m, kRayFraction * returned_light(*hit, ray.direction)};
    }
  }
  return detect(returns);
}

// Diffuse reflection (Lambert) that falls with the square of the distance. The part of a
// reflector's reflectivity above 1 counts only if the beam hits it nearly at a right angle.
double Rangefinder::returned_light(const Hit& hit, const Eigen::Vector3d& direction) const {
  const double cosine = -hit.normal.dot(direction);
  double reflected = std::min(hit.reflectivity, 1.0) * cosine;
  if (hit.reflectivity > 1.0 && cosine >= std::cos(params_.dazzle_angle_rad)) {
    reflected += hit.reflectivity - 1.0;
  }
  const double nearness = std::min(1.0, kNearM / hit.distance_m);
  return reflected * nearness * nearness;
}

// Surfaces closer together than the pulse length merge into one echo, at the mean of their ranges
// weighted by light: a mixed pixel. The first echo that is bright enough is the result.
Echo Rangefinder::detect(std::array<Return, kRays> returns) {
  std::ranges::sort(returns, {}, &Return::range_m);
  for (std::size_t first = 0; first < kRays && returns[first].range_m < kNoHit;) {
    const double last_m = returns[first].range_m + params_.pulse_length_m;
    double light = 0.0;
    double moment = 0.0;
    for (; first < kRays && returns[first].range_m <= last_m; ++first) {
      light += returns[first].light;
      moment += returns[first].light * returns[first].range_m;
    }
    if (light > 1.0) {
      return {Echo::Kind::kDazzled, 0.0, 1.0};
    }
    if (light > 0.0 && light >= params_.min_intensity) {
      const double error_m = params_.range_bias_m + params_.range_sigma_m * normal_(engine_);
      return {Echo::Kind::kRange, std::max(0.0, moment / light + error_m), light};
    }
  }
  return {};
}

}  // namespace nodmap::sim
