// SPDX-License-Identifier: BSD-3-Clause
// The whole robot as processes in real time: how fast it reacts over a long run, and how it stops
// when a part of it is killed, unplugged or broken. Run by `./nodmap bench`, on a network of its
// own.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "bench/live/robot_processes.hpp"
#include "bench/live/stop_measure.hpp"
#include "common/bus/live_bus.hpp"
#include "nodmap/truth_t.hpp"
#include "tools/latency/reaction.hpp"

namespace nodmap::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kDecelerationMps2 = 3.0;  // of the base driver's ramp on command
constexpr double kMaxExcessS = 0.3;        // what is promised
constexpr double kMaxExcessM = 0.3;
constexpr double kFaultAtS = 12.0;  // after the simulator's start: the robot is on its way
constexpr double kFaultForS = 3.0;
constexpr double kDrivingMps = 1.2;

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Listens to what really happens.
class Witness {
 public:
  Witness() : bus_("") {
    bus_.subscribe<nodmap::truth_t>("TRUTH", [this](const nodmap::truth_t& truth) {
      collisions_ = truth.collisions;
      motions_.push_back({truth.utime, truth.position_m[0], truth.position_m[1], truth.forward_mps,
                          truth.yaw_rate_rad_s});
    });
  }

  /// Listens until `done` or for `seconds`; whether it was done.
  template <class Done>
  bool listen(double seconds, Done done) {
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < end) {
      bus_.handle(std::chrono::milliseconds(5));
      if (done()) {
        return true;
      }
    }
    return false;
  }
  void listen(double seconds) {
    listen(seconds, [] { return false; });
  }
  [[nodiscard]] bool driving(double at_least_mps) const {
    return !motions_.empty() && motions_.back().forward_mps > at_least_mps;
  }
  [[nodiscard]] const std::vector<Motion>& motions() const { return motions_; }
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }

 private:
  bus::LiveBus bus_;
  std::vector<Motion> motions_;
  std::int64_t collisions_ = 0;
};

struct Case {
  std::string name;
  std::string process;  ///< to kill, or
  std::string fault;    ///< to happen to a device
  bool stops = true;    ///< the robot must stand; else it drives on
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
  std::optional<Stop> stop;
  bool goes_on = false;
  std::int64_t collisions = 0;
};

/// Kills the process while the robot drives, waits, starts it anew. The moment of the kill.
std::optional<std::int64_t> kill_and_restart(RobotProcesses& robot, Witness& witness,
                                             const std::string& process) {
  witness.listen(5.0);
  if (!witness.listen(30.0, [&] { return witness.driving(kDrivingMps); })) {
    return std::nullopt;
  }
  const std::int64_t at_us = now_us();
  robot.kill(process);
  witness.listen(kFaultForS);
  robot.start(process);
  return at_us;
}

std::optional<std::int64_t> wait_for_fault(Witness& witness) {
  if (!witness.listen(10.0, [&] { return !witness.motions().empty(); })) {
    return std::nullopt;
  }
  const auto at_us =
      witness.motions().front().utime_us + static_cast<std::int64_t>(1e6 * kFaultAtS);
  witness.listen(kFaultAtS + kFaultForS);
  return at_us;
}

Outcome examine(const Case& what, RobotProcesses::Options options) {
  if (!what.fault.empty()) {
    std::ostringstream fault;
    fault << what.fault << "@" << kFaultAtS << "+" << kFaultForS;
    options.faults = {fault.str()};
  }
  Witness witness;
  RobotProcesses robot(options);
  const auto at_us = what.process.empty() ? wait_for_fault(witness)
                                          : kill_and_restart(robot, witness, what.process);
  Outcome outcome;
  if (at_us) {
    outcome.stop = measure_stop(witness.motions(), *at_us);
    outcome.goes_on = witness.listen(20.0, [&] { return witness.driving(0.1); });
  }
  outcome.collisions = witness.collisions();
  return outcome;
}

bool keeps_promise(const Case& what, const Outcome& outcome) {
  if (!outcome.goes_on || outcome.collisions > 0) {
    return false;
  }
  return !what.stops ||
         (outcome.stop && outcome.stop->excess_time_s(kDecelerationMps2) <= kMaxExcessS &&
          outcome.stop->excess_way_m(kDecelerationMps2) <= kMaxExcessM);
}

void print(const Case& what, const Outcome& outcome) {
  std::printf("%-26s", what.name.c_str());
  if (!what.stops) {
    std::printf(" %36s", "drives on");
  } else if (outcome.stop) {
    std::printf(" from %4.2f m/s: %5.0f ms and %5.2f m beyond", outcome.stop->speed_mps,
                1e3 * outcome.stop->excess_time_s(kDecelerationMps2),
                outcome.stop->excess_way_m(kDecelerationMps2));
  } else {
    std::printf(" %36s", "did not stand");
  }
  std::printf("  %s  collisions %lld  %s\n", outcome.goes_on ? "goes on" : "STAYS  ",
              static_cast<long long>(outcome.collisions),
              keeps_promise(what, outcome) ? "ok" : "MISS");
  std::fflush(stdout);
}

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

double resident_mib(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  long total = 0;
  long resident = 0;
  file >> total >> resident;
  return static_cast<double>(resident) * 4096.0 / (1024.0 * 1024.0);
}

nlohmann::ordered_json to_json(const std::vector<latency::Sample>& samples) {
  const latency::Summary summary = latency::summarize(samples);
  return {{"n", summary.n},
          {"p50_us", summary.p50_us},
          {"p99_us", summary.p99_us},
          {"max_us", summary.max_us},
          {"p99_us_over_time", latency::p99_over_time(samples, 10)}};
}

int run_latency(const RobotProcesses::Options& options, double duration_s) {
  latency::Reaction reaction;
  bus::LiveBus bus("");
  bus.subscribe_all(
      [&reaction](const bus::LiveBus::RawMessage& message) {
        reaction.hear(message.channel, message.data, message.receive_utime_us);
      },
      1000);
  Witness witness;
  RobotProcesses robot(options);
  const auto end = Clock::now() + std::chrono::duration<double>(duration_s);
  while (Clock::now() < end) {
    bus.handle(std::chrono::milliseconds(20));
    witness.listen(0.0);
  }
  nlohmann::ordered_json memory;
  for (const auto& [name, pid] : robot.pids()) {
    memory[name] = resident_mib(pid);
  }
  const auto bad = robot.stop();
  const nlohmann::ordered_json result = {{"duration_s", duration_s},
                                         {"scans", reaction.scans()},
                                         {"lost", reaction.lost()},
                                         {"collisions", witness.collisions()},
                                         {"scan_to_obstacle_map", to_json(reaction.scan_to_map())},
                                         {"scan_to_drive", to_json(reaction.scan_to_drive())},
                                         {"resident_mib", memory},
                                         {"ended_badly", bad}};
  std::cout << result.dump(2) << "\n";
  return bad.empty() && witness.collisions() == 0 ? 0 : 1;
}

int run(int argc, char** argv) {
  RobotProcesses::Options options;
  options.bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::string only;
  double duration_s = 600.0;
  CLI::App app("The whole robot as processes in real time.", "nodmap-bench-live");
  app.require_subcommand(1);
  app.add_option("--world", options.world, "WORLD.yaml")->required();
  app.add_option("--out", options.out, "A new folder for logs")->required();
  CLI::App* faults =
      app.add_subcommand("faults", "Kills and breaks each part while the robot drives");
  faults->add_option("--only", only, "Cases with this in their name");
  CLI::App* latency = app.add_subcommand("latency", "Measures how fast the robot reacts, as JSON");
  latency->add_option("--duration", duration_s, "Seconds")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (std::filesystem::exists(options.out)) {
    std::cerr << options.out << " exists; results are never overwritten\n";
    return 2;
  }
  return faults->parsed() ? run_faults(options, only) : run_latency(options, duration_s);
}

}  // namespace
}  // namespace nodmap::bench

int main(int argc, char** argv) {
  try {
    return nodmap::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "nodmap-bench-live: " << error.what() << "\n";
    return 1;
  }
}
