// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "procman/config/config.hpp"
#include "procman/sheriff/sheriff.hpp"

namespace nodmap::procman {

enum class AfterScript : std::uint8_t { kExit, kStay, kObserve };

struct WatchOptions {
  const Script* script = nullptr;  ///< null: only watch
  AfterScript after_script = AfterScript::kStay;
  std::optional<double> timeout_s;  ///< for the script
  bool observe = false;             ///< only observe; give no orders
  std::string config_file;          ///< reloaded when it is edited
};

/// Runs a script and applies the health rules: in the live view on a terminal, else with a line on
/// stdout for each change. Returns the exit code.
int watch(Sheriff& sheriff, const WatchOptions& options);

}  // namespace nodmap::procman
