// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>

#include "common/geometry/se3.hpp"
#include "sim/body/params.hpp"
#include "sim/world/ray_caster.hpp"

namespace nodmap::sim {

/// The result of one beam.
struct Echo {
  enum class Kind : std::uint8_t { kRange, kNothing, kDazzled };
  Kind kind = Kind::kNothing;
  double range_m = 0.0;    ///< with the sensor's noise; for kRange only
  double intensity = 0.0;  ///< relative to a white surface at 1 m, 0..1
};

/// Model of the SICK LMS200: measures beam by beam. A beam is a spot that grows with the distance,
/// sampled by a few rays whose echoes are weighted by their light.
class Rangefinder {
 public:
  /// Rays per beam: one in the middle, the others around it; each stands for an equal area.
  static constexpr std::size_t kRays = 5;

  Rangefinder(const LaserParams& params, std::uint64_t seed) : params_(params), engine_(seed) {}

  /// Measures one beam at `angle_rad` in the x-y plane of `T_world_laser` (0 along x, positive
  /// left).
  [[nodiscard]] Echo measure(const RayCaster& caster, const geometry::SE3& T_world_laser,
                             double angle_rad, std::span<const ActorState> actors);

 private:
  /// The echo of one ray; `light` is a fraction of the beam's light.
  struct Return {
    double range_m = kNoHit;
    double light = 0.0;
  };

  [[nodiscard]] double returned_light(const Hit& hit, const Eigen::Vector3d& direction) const;
  [[nodiscard]] Echo detect(std::array<Return, kRays> returns);

  LaserParams params_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace nodmap::sim
