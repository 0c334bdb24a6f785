// SPDX-License-Identifier: BSD-3-Clause
// nodmap-bench-live: runs the whole robot as processes in real time and measures its reaction times
// over a long run, how it stops when a part is killed, unplugged or broken, and what it does under
// attack. Run by `./nodmap bench` in a private network.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/live/attacks.hpp"
#include "bench/live/endurance.hpp"
#include "bench/live/faults.hpp"

namespace nodmap::bench {
namespace {

// One line for each channel and process.
void print(const nlohmann::ordered_json& report) {
  std::cout << "{\n";
  for (auto entry = report.begin(); entry != report.end(); ++entry) {
    std::cout << (entry == report.begin() ? "" : ",\n") << "  \"" << entry.key() << "\": ";
    const bool is_table = entry->is_object() && !entry->empty() && entry->front().is_object();
    if (!is_table) {
      std::cout << entry->dump();
      continue;
    }
    std::cout << "{";
    for (auto row = entry->begin(); row != entry->end(); ++row) {
      std::cout << (row == entry->begin() ? "\n" : ",\n") << "    \"" << row.key()
                << "\": " << row->dump();
    }
    std::cout << "\n  }";
  }
  std::cout << "\n}\n";
}

int run_latency(const RobotProcesses::Options& robot, const Endurance::Options& options) {
  Endurance endurance(robot, options);
  print(endurance.run());
  return endurance.is_sound() ? 0 : 1;
}

int run(int argc, char** argv) {
  RobotProcesses::Options robot;
  robot.bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::string only;
  Endurance::Options options;
  CLI::App app("Measures the whole robot, run as processes in real time.", "nodmap-bench-live");
  app.require_subcommand(1);
  app.add_option("--world", robot.world, "WORLD.yaml")->required();
  app.add_option("--out", robot.out, "New folder for logs")->required();
  CLI::App* faults =
      app.add_subcommand("faults", "Kills or breaks each part while the robot drives");
  faults->add_option("--only", only, "Run only cases with this in their name");
  double attack_s = 60.0;
  CLI::App* attacks = app.add_subcommand(
      "attacks", "Forges messages and datagrams while the robot drives, and prints a table");
  attacks->add_option("--only", only, "Run only attacks with this in their name");
  attacks->add_option("--duration", attack_s, "Duration of each attack (s)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::App* latency =
      app.add_subcommand("latency",
                         "Measures reaction times, CPU time and memory, and prints JSON; exits "
                         "with 1 if the robot is too slow, a message is lost or something is hit");
  latency->add_option("--duration", options.duration_s, "Measured time (s)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  latency->add_option("--warm-up", options.warm_up_s, "Time before the measurement (s)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  latency->add_flag("--viewer", options.viewer,
                    "Run nodmap-viewer with one client in the second half");
  latency->add_flag("--any-timing", options.any_timing, "Do not fail if the robot is slow");
  CLI11_PARSE(app, argc, argv);
  if (std::filesystem::exists(robot.out)) {
    std::cerr << robot.out << " exists; results are never overwritten\n";
    return 2;
  }
  if (attacks->parsed()) {
    return run_attacks(robot, only, attack_s);
  }
  return faults->parsed() ? run_faults(robot, only) : run_latency(robot, options);
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
