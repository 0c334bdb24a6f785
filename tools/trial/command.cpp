// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/command.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/formats/number.hpp"

namespace nodmap::trial {
namespace {

constexpr std::array<std::string_view, 8> kProcesses{"kurt",       "laser3d",   "pitch_controller",
                                                     "map_server", "navigator", "explorer",
                                                     "slam2d",     "slam6d"};

// Rounds to whole milliseconds, the step of the loop.
time::Duration whole_steps(double duration_s) {
  return 1ms * std::llround(1e3 * duration_s);
}

}  // namespace

void check_process(std::string_view process, const std::string& source) {
  if (std::ranges::find(kProcesses, process) != kProcesses.end()) {
    return;
  }
  std::string names;
  for (const std::string_view name : kProcesses) {
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  throw CommandError(source + ": no such process; there are " + names);
}

Kill parse_kill(const std::string& text) {
  const std::string source = "--kill " + text;
  const std::size_t at = text.find('@');
  const std::size_t plus = text.find('+', at == std::string::npos ? 0 : at);
  if (at == std::string::npos || plus == std::string::npos) {
    throw CommandError(source + ": must be PROCESS@T+D, such as navigator@10+2");
  }
  check_process(text.substr(0, at), source);
  const auto time_s =
      formats::parse_number<double>(std::string_view(text).substr(at + 1, plus - at - 1));
  const auto duration_s = formats::parse_number<double>(std::string_view(text).substr(plus + 1));
  constexpr double kLongestS = 86'400.0;
  if (!time_s || !duration_s || !(*time_s >= 0.0 && *time_s <= kLongestS) ||
      !(*duration_s >= 0.001 && *duration_s <= kLongestS)) {
    throw CommandError(source + ": T and D must be seconds, T from 0, D from 0.001");
  }
  return {text.substr(0, at), time::SteadyTime(whole_steps(*time_s)), whole_steps(*duration_s)};
}

void check_kills(const TrialSetup& setup) {
  const std::set<std::string> omitted = omitted_processes(setup);
  for (const Kill& kill : setup.kills) {
    if (omitted.contains(kill.process)) {
      throw CommandError("--kill: " + kill.process + " does not run in this trial");
    }
  }
}

}  // namespace nodmap::trial
