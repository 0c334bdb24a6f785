// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "sim/world.hpp"

namespace nodmap::trial {

/// The robot's way of stopping, as a witness knows it.
struct StoppingWay {
  double body_length_m = 0.45;
  double body_width_m = 0.33;
  double deceleration_mps2 = 1.5;
  double processing_s = 0.05;  ///< beside the two sweeps (R29)
  double margin_m = 0.15;      ///< left when it stands

  /// From the robot's front, while the laser may need two sweeps to look at what is new.
  [[nodiscard]] double length_m(double forward_mps, double sweep_s) const;
};

/// One obstacle that came into the way.
struct BrakeEvent {
  std::int64_t began_us = 0;
  double speed_mps = 0.0;
  double sweep_s = 0.0;                     ///< at its beginning
  std::optional<std::int64_t> answered_us;  ///< empty: not before the end of the trial
};

/// Measures how long the robot takes to answer an obstacle that comes into its way (R32).
///
/// It begins when an actor that a beam could meet (it is there, and nothing stands between it and
/// the mirror) first touches the stopping way: the strip ahead of the robot's front, as wide as the
/// body, in which the robot must brake at once to stand in time. It ends with the first DRIVE that
/// brakes: 10 %, and at least 0.1 m/s, below the robot's speed at the beginning. What leaves the
/// way before (the robot turned away, or the actor went on) is no event; nor is anything while the
/// robot is slower than 0.3 m/s, where braking cannot be told from noise.
class BrakeWatch {
 public:
  static constexpr double kSlowestMps = 0.3;

  explicit BrakeWatch(const StoppingWay& way) : way_(way) {}

  struct Moment {
    std::int64_t time_us = 0;
    geometry::SE2 T_world_base;
    double forward_mps = 0.0;
    double sweep_s = 0.0;  ///< as the last one took
    /// One for each actor of the world; empty: not there, or hidden.
    std::vector<std::optional<sim::ActorState>> visible;
  };
  void see(const Moment& moment);
  /// A DRIVE comes to the base.
  void hear_drive(std::int64_t time_us, double forward_mps);

  /// In the order of their beginning; those that are not answered last of all.
  [[nodiscard]] std::vector<BrakeEvent> events() const;
  [[nodiscard]] std::int64_t evaded() const { return evaded_; }

 private:
  struct Watched {
    bool in_the_way = false;
    std::optional<BrakeEvent> open;
  };

  StoppingWay way_;
  std::vector<Watched> actors_;
  std::vector<BrakeEvent> answered_;
  std::int64_t evaded_ = 0;
};

}  // namespace nodmap::trial
