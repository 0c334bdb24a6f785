// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "common/node/map_options.hpp"
#include "sim/devices/fault.hpp"
#include "sim/world/world.hpp"
#include "tools/trial/brake_latency.hpp"
#include "tools/trial/exploration_monitor.hpp"
#include "tools/trial/occupancy_metrics.hpp"
#include "tools/trial/params.hpp"
#include "tools/trial/record.hpp"
#include "tools/trial/robots.hpp"

namespace nodmap::trial {

/// A process that is killed at a time after power-on and restarted later.
struct Kill {
  std::string process;
  time::SteadyTime begin{};
  time::Duration duration{};
};

struct TrialSetup {
  sim::World world;
  Robot robot = Robot::kKurt3d;  ///< the robot whose values `params` contains: set_robot()
  AllParams params;
  std::uint64_t seed = 0;
  time::Duration duration{};  ///< from the first SCAN on
  node::MapOptions map;       ///< that 2D SLAM is given
  std::set<std::string> without;
  std::vector<Kill> kills;
  std::vector<sim::Fault> faults;
  bool explores = false;       ///< the explorer runs, and ends the trial when it is home
  bool level_laser = false;    ///< also map with the laser held level on the same drive
  UndisturbedRun undisturbed;  ///< with which the brake latency is measured
};

/// The result of a trial.
struct TrialOutcome {
  TrialRecord record;
  ObservedVoxels observed_voxels;
  std::vector<BrakeEvent> brake_events;
  std::optional<ExplorationRecord> exploration;  ///< if the explorer ran
  std::int64_t num_evaded = 0;  ///< obstacles that the robot steered past instead of braking
  std::int64_t num_masked = 0;  ///< without them the robot would have slowed down as well
  nlohmann::json processes;     ///< by process: message counts and metrics
};

/// Runs the whole robot in a world, in one closed loop on simulated time. The same setup gives the
/// same outcome and files.
class Trial {
 public:
  /// Step of the loop. A USB adapter delivers bytes once a millisecond, and nothing is faster.
  static constexpr time::Duration kStep = 1ms;

  /// Logs into `dir`/trial.lcmlog. Throws std::runtime_error if it cannot be created.
  Trial(const TrialSetup& setup, const std::filesystem::path& dir);
  ~Trial();

  /// Simulates one step; returns false when the trial is over: after the duration, a second after
  /// the robot has reported its arrival at the world's last goal or the end of its exploration, or
  /// by the rules of the world's task. Throws std::runtime_error when no scan comes within a
  /// minute, and when the program has been told to stop.
  bool step();

  [[nodiscard]] time::SteadyTime now() const { return now_; }
  [[nodiscard]] const TrialRecord& record() const;

  /// Ends the processes, which write their results into `dir`. Throws std::runtime_error.
  [[nodiscard]] TrialOutcome finish();

 private:
  struct Parts;

  [[nodiscard]] bool is_over() const;
  [[nodiscard]] bool has_arrived() const;
  [[nodiscard]] bool has_explored() const;
  [[nodiscard]] bool has_failed() const;
  void apply_kills();

  TrialSetup setup_;
  std::filesystem::path dir_;
  std::unique_ptr<Parts> parts_;
  time::SteadyTime now_{};
};

/// Removes the logs of a trial from its folder.
void remove_logs(const std::filesystem::path& dir);

/// The processes that do not run: those of `without`, and the explorer unless it is requested.
[[nodiscard]] std::set<std::string> omitted_processes(const TrialSetup& setup);

/// The stopping zone for measuring the brake latency.
[[nodiscard]] StoppingZone stopping_zone(const TrialSetup& setup);

}  // namespace nodmap::trial
