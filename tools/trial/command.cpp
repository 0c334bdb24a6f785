// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/command.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace nodmap::trial {
namespace {

constexpr std::array<std::string_view, 8> kProcesses{"kurt",       "laser3d",   "pitch_controller",
                                                     "map_server", "navigator", "explorer",
                                                     "slam2d",     "slam6d"};

template <class Number>
std::optional<Number> parse(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number)
                                                                  : std::nullopt;
}

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
  const auto time_s = parse<double>(std::string_view(text).substr(at + 1, plus - at - 1));
  const auto duration_s = parse<double>(std::string_view(text).substr(plus + 1));
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
