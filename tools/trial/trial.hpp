// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "sim/fault.hpp"
#include "sim/world.hpp"
#include "tools/trial/brake_watch.hpp"
#include "tools/trial/params.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// PROCESS is killed T seconds after power-on and started anew D seconds later.
struct Kill {
  std::string process;
  std::int64_t at_us = 0;
  std::int64_t for_us = 0;
};

struct TrialSetup {
  sim::World world;
  AllParams params;
  std::uint64_t seed = 0;
  std::int64_t duration_us = 0;  ///< from the first SCAN on
  std::set<std::string> without;
  std::vector<Kill> kills;
  std::vector<sim::Fault> faults;
};

/// What came of it.
struct TrialOutcome {
  TrialRecord record;
  std::vector<BrakeEvent> brake_events;
  std::int64_t evaded = 0;   ///< obstacles that the robot steered past instead of braking
  nlohmann::json processes;  ///< by process: messages and figures
};

/// The whole robot in a world, in one closed loop on simulated time. The same setup gives the same
/// outcome and files.
class Trial {
 public:
  /// The loop's step. A USB adapter hands over what has come once a millisecond; nothing in the
  /// loop is in a greater hurry.
  static constexpr std::int64_t kStepUs = 1000;

  /// Logs into `dir`/trial.lcmlog. Throws std::runtime_error when it cannot be made.
  Trial(const TrialSetup& setup, const std::filesystem::path& dir);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  Trial(Trial&&) = delete;
  Trial& operator=(Trial&&) = delete;

  /// One step of simulated time; false when the trial is over: after the duration, or a second
  /// after the robot has arrived at the world's goal. Throws std::runtime_error when no scan comes
  /// within a minute.
  bool step();

  [[nodiscard]] std::int64_t now_us() const { return now_us_; }
  [[nodiscard]] const TrialRecord& record() const;

  /// Ends the processes, which write their results into `dir`. Throws std::runtime_error.
  [[nodiscard]] TrialOutcome finish();

 private:
  struct Parts;

  [[nodiscard]] bool is_over() const;
  void do_kills();

  TrialSetup setup_;
  std::filesystem::path dir_;
  std::unique_ptr<Parts> parts_;
  std::int64_t now_us_ = 0;
};

/// The way of stopping that the setup's robot is judged by.
[[nodiscard]] StoppingWay stopping_way(const TrialSetup& setup);

}  // namespace nodmap::trial
