// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <span>

#include "common/geometry/se3.hpp"
#include "sim/plant_params.hpp"
#include "sim/ray_caster.hpp"

namespace nodmap::sim {

/// What one beam brings back.
struct Echo {
  enum class Kind : std::uint8_t { kRange, kNothing, kDazzled };
  Kind kind = Kind::kNothing;
  double range_m = 0.0;    ///< with the sensor's noise; only with kRange
  double intensity = 0.0;  ///< share of the emitted light that came back, 0..1
};

/// What a SICK LMS200 makes of its surroundings, beam by beam. A beam is a spot that grows with the
/// distance, probed by a few rays; what they bring back is weighed by light.
class Rangefinder {
 public:
  /// The number of rays in a beam: in the middle, and around it where they share the spot evenly.
  static constexpr std::size_t kRays = 5;

  Rangefinder(const PlantParams& params, std::uint64_t seed) : params_(params), engine_(seed) {}

  /// One beam at `angle_rad` in the x-y plane of `T_world_laser` (0 along x, positive left).
  [[nodiscard]] Echo measure(const RayCaster& caster, const geometry::SE3& T_world_laser,
                             double angle_rad, std::span<const ActorState> actors);

 private:
  /// What one ray brings back: its share of the light of the beam.
  struct Return {
    double range_m = kNoHit;
    double light = 0.0;
  };

  [[nodiscard]] double light_of(const Hit& hit, const Eigen::Vector3d& direction) const;
  [[nodiscard]] Echo receive(std::array<Return, kRays> returns);

  PlantParams params_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace nodmap::sim
