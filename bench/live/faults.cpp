// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/faults.hpp"

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <sstream>
#include <vector>

#include "bench/live/robot_observer.hpp"
#include "bench/live/stop_metrics.hpp"
#include "common/geometry/clock.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::bench {
namespace {

// Of the base driver when it is commanded to stop.
constexpr double kDecelerationMps2 = kurt::SpeedLimits{}.max_deceleration_mps2;
constexpr double kMaxExcessS = 0.3;  // promised by SAFETY.md
constexpr double kMaxExcessM = 0.3;
constexpr double kFaultAtS = 12.0;  // after the simulator's start: the robot is driving
constexpr double kFaultForS = 2.5;  // a plug that is back within 3.1 s needs no release
constexpr double kDrivingMps = 1.2;
constexpr double kDrivesOnMps = kDrivingMps / 2;  // when the fault begins, and again afterwards
constexpr double kDrivesOnWithinS = 20.0;         // of its end

struct Case {
  std::string name;
  std::string process;  // the process to kill, or
  std::string fault;    // the device fault to cause
  bool stops = true;    // true: the robot must stop; false: it must drive on
};

const std::vector<Case> kCases = {
    {"kill -9 laser3d", "laser3d", ""},       {"kill -9 kurt", "kurt", ""},
    {"kill -9 map-server", "map-server", ""}, {"kill -9 pitch-controller", "pitch-controller", ""},
    {"kill -9 navigator", "navigator", ""},   {"kill -9 slam2d", "slam2d", "", false},
    {"kill -9 slam6d", "slam6d", "", false},  {"kill -9 logger", "logger", "", false},
    {"laser unplugged", "", "laser:unplug"},  {"servo unplugged", "", "servo:unplug"},
    {"base unplugged", "", "base:unplug"},    {"laser frozen", "", "laser:freeze"},
    {"laser silent", "", "laser:silent"},     {"servo stalled", "", "servo:stall"},
};

struct Outcome {
  std::optional<StopMetrics> stop;
  bool goes_on = false;
  std::int64_t collisions = 0;
};

// Kills the process while the robot drives, waits, and restarts it. Returns the time of the kill.
std::optional<time::Timestamp> kill_and_restart(RobotProcesses& robot, RobotObserver& observer,
                                                const std::string& process) {
  observer.listen(5.0);
  if (!observer.listen(30.0, [&] { return observer.driving(kDrivingMps); })) {
    return std::nullopt;
  }
  const time::Timestamp at = time::SystemClock().now();
  robot.kill(process);
  observer.listen(kFaultForS);
  robot.start(process);
  if (process == "kurt" || process == "navigator") {
    robot.release();
  }
  return at;
}

std::optional<time::Timestamp> wait_for_fault(RobotObserver& observer) {
  if (!observer.listen(10.0, [&] { return !observer.motions().empty(); })) {
    return std::nullopt;
  }
  const time::Timestamp at = observer.motions().front().stamp + time::from_seconds(kFaultAtS);
  observer.listen(kFaultAtS + kFaultForS);
  return at;
}

Outcome examine(const Case& what, RobotProcesses::Options options) {
  if (!what.fault.empty()) {
    std::ostringstream fault;
    fault << what.fault << "@" << kFaultAtS << "+" << kFaultForS;
    options.faults = {fault.str()};
  }
  RobotObserver observer;
  RobotProcesses robot(options);
  const auto at = what.process.empty() ? wait_for_fault(observer)
                                       : kill_and_restart(robot, observer, what.process);
  Outcome outcome;
  if (at) {
    outcome.stop = stop_metrics(observer.motions(), *at);  // until the fault's end
    outcome.goes_on =
        observer.listen(kDrivesOnWithinS, [&] { return observer.driving(kDrivesOnMps); });
  }
  outcome.collisions = observer.collisions();
  return outcome;
}

// A robot that is stationary when the fault begins shows nothing.
bool was_driving(const StopMetrics& stop) {
  return stop.speed_mps >= kDrivesOnMps;
}

bool keeps_promise(const Case& what, const Outcome& outcome) {
  if (!outcome.goes_on || outcome.collisions > 0) {
    return false;
  }
  if (!what.stops) {
    return !outcome.stop;
  }
  return outcome.stop && was_driving(*outcome.stop) &&
         outcome.stop->excess_time_s(kDecelerationMps2) <= kMaxExcessS &&
         outcome.stop->excess_distance_m(kDecelerationMps2) <= kMaxExcessM;
}

void print(const Case& what, const Outcome& outcome) {
  std::printf("%-26s", what.name.c_str());
  if (!what.stops) {
    std::printf(" %50s", outcome.stop ? "stopped" : "drives on");
  } else if (outcome.stop && !was_driving(*outcome.stop)) {
    std::printf(" %50s", "was not driving");
  } else if (outcome.stop) {
    std::printf(" from %4.2f m/s: %5.0f ms and %5.2f m beyond braking", outcome.stop->speed_mps,
                1e3 * outcome.stop->excess_time_s(kDecelerationMps2),
                outcome.stop->excess_distance_m(kDecelerationMps2));
  } else {
    std::printf(" %50s", "did not stop");
  }
  std::printf("  %s  collisions %lld  %s\n", outcome.goes_on ? "drives on    " : "STAYS STOPPED",
              static_cast<long long>(outcome.collisions),
              keeps_promise(what, outcome) ? "ok" : "MISS");
  std::fflush(stdout);
}

}  // namespace

int run_faults(RobotProcesses::Options options, const std::string& only) {
  int missed = 0;
  const auto root = options.out;
  for (const Case& what : kCases) {
    if (what.name.find(only) == std::string::npos) {
      continue;
    }
    options.out = root / ("case" + std::to_string(&what - kCases.data()));
    const Outcome outcome = examine(what, options);
    print(what, outcome);
    missed += keeps_promise(what, outcome) ? 0 : 1;
  }
  return missed == 0 ? 0 : 1;
}

}  // namespace nodmap::bench
