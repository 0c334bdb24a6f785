// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/robot_params.hpp"
#include "modules/pitch_controller/params.hpp"
#include "sim/world/world.hpp"

namespace nodmap::trial {

/// The strip ahead of the robot's front, as wide as the body, in which an obstacle must make it
/// brake at once.
struct StoppingZone {
  robot::Footprint footprint = robot::Body{}.footprint();
  robot::Braking braking;
  pitch_controller::DetectionParams detection;

  /// Length of the strip: the required distance, with a reaction time of two sweeps and processing,
  /// because the laser may need two sweeps to detect a new obstacle.
  [[nodiscard]] double length_m(double forward_mps, double sweep_s) const;
};

/// An obstacle that entered the stopping zone.
struct BrakeEvent {
  time::SteadyTime started{};
  double speed_mps = 0.0;  ///< of the robot, or the commanded one, whichever is lower
  double sweep_s = 0.0;    ///< duration of the last sweep at that time
  /// When the robot braked; empty: not before the end of the trial.
  std::optional<time::SteadyTime> answered;

  /// Within which it should brake: two sweeps, a scan, and 20 ms (R32).
  [[nodiscard]] time::Duration limit() const {
    constexpr time::Duration kScanAndProcessing = 33'320us;
    return time::from_seconds(2.0 * sweep_s) + kScanAndProcessing;
  }
};

/// The same trial without one of its obstacles. Until a beam hits the obstacle, both are alike.
struct UndisturbedRun {
  std::size_t actor = 0;  ///< that is absent
  /// Forward speed of each DRIVE, by drive_seq, until a while after the obstacle would have
  /// appeared.
  std::map<std::int64_t, double> drives_mps;
};

/// Measures the time from the moment at which an obstacle enters the stopping zone until the robot
/// brakes.
///
/// It starts when an actor in the stopping zone is first such that a beam could hit it: nothing is
/// between it and the mirror. One that is hidden later stays what it was. It ends with the first
/// DRIVE that is 10 %, and at least 0.1 m/s, below the robot's speed at the start, the one that was
/// then commanded, and the DRIVE of the same number in the undisturbed run: a robot that slows down
/// for a bend has not reacted to the obstacle. If within the limit of the event the undisturbed
/// robot is told to drive slower than 0.3 m/s, braking could not be distinguished from that, and
/// the event counts as masked. An actor that leaves the zone before (because it moved on, or the
/// robot turned away) counts as evaded; for an actor inside, the zone does not become shorter when
/// the robot slows down. Below 0.3 m/s nothing is measured, because braking could not be
/// distinguished from noise.
class BrakeLatencyMonitor {
 public:
  static constexpr double kMinSpeedMps = 0.3;

  /// Without an undisturbed run any DRIVE that is so much lower is an answer.
  explicit BrakeLatencyMonitor(const StoppingZone& zone, UndisturbedRun undisturbed = {})
      : zone_(zone), undisturbed_(std::move(undisturbed)) {}

  struct Actor {
    sim::ActorState state;
    bool is_visible = true;
  };
  struct State {
    time::SteadyTime instant{};
    geometry::SE2 T_world_base;
    double forward_mps = 0.0;
    double sweep_s = 0.0;  ///< duration of the last sweep
    /// One for each actor of the world; empty if it is absent.
    std::vector<std::optional<Actor>> actors;
  };
  void update(const State& state);
  /// Adds a DRIVE received by the base.
  void add_drive_command(time::SteadyTime received, std::int64_t drive_seq, double forward_mps);

  /// All events in the order of their start, unanswered ones last.
  [[nodiscard]] std::vector<BrakeEvent> events() const;
  [[nodiscard]] std::int64_t num_evaded() const { return num_evaded_; }
  [[nodiscard]] std::int64_t num_masked() const { return num_masked_; }

 private:
  struct TrackedActor {
    bool in_zone = false;  // and has been visible there
    double reach_m = 0.0;  // the longest zone since it entered
    std::optional<BrakeEvent> open_event;
  };

  /// Forward speed of this DRIVE if the actor had been absent; empty if that is unknown.
  [[nodiscard]] std::optional<double> undisturbed_mps(std::size_t actor,
                                                      std::int64_t drive_seq) const;

  StoppingZone zone_;
  UndisturbedRun undisturbed_;
  double drive_mps_ = 0.0;  // commanded last
  std::vector<TrackedActor> actors_;
  std::vector<BrakeEvent> answered_;
  std::int64_t num_evaded_ = 0;
  std::int64_t num_masked_ = 0;
};

}  // namespace nodmap::trial
