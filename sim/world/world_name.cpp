// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world_name.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "common/formats/number.hpp"
#include "common/formats/user_error.hpp"
#include "sim/world/barn_file.hpp"
#include "sim/world/pedestrian_file.hpp"
#include "sim/world/scenarios/scenarios.hpp"
#include "sim/world/world_file.hpp"

namespace nodmap::sim {
namespace {

// Splits a text at its colons.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ':');) {
    parts.push_back(part);
  }
  return parts;
}

World load_barn(const std::string& name) {
  const std::vector<std::string> parts = split(name);
  const auto index = parts.size() == 3 ? formats::parse_number<int>(parts[2]) : std::nullopt;
  if (!index) {
    throw formats::UserError(name + ": must be barn:FILE:INDEX");
  }
  return load_barn_world(parts[1], *index);
}

World load_recorded_crowd(const std::string& name) {
  const std::vector<std::string> parts = split(name);
  const auto rate = parts.size() == 4 ? formats::parse_number<double>(parts[2]) : std::nullopt;
  const auto seed =
      parts.size() == 4 ? formats::parse_number<std::uint64_t>(parts[3]) : std::nullopt;
  if (!rate || !seed || !(*rate > 0.0)) {
    throw formats::UserError(name + ": must be pedestrians:FILE:FRAMES_PER_SECOND:SEED");
  }
  return load_pedestrians(parts[1], *rate, *seed);
}

}  // namespace

World make_world(const std::string& name) {
  const std::string_view text = name;
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  if (colon != std::string_view::npos && kind == "barn") {
    return load_barn(name);
  }
  if (colon != std::string_view::npos && kind == "pedestrians") {
    return load_recorded_crowd(name);
  }
  for (const Scenario& scenario : scenarios()) {
    if (colon != std::string_view::npos && kind == scenario.name) {
      const auto seed = formats::parse_number<std::uint64_t>(text.substr(colon + 1));
      if (!seed) {
        throw formats::UserError(name + ": must be " + std::string(kind) + ":SEED, such as " +
                                 std::string(kind) + ":1");
      }
      return scenario.make(*seed);
    }
  }
  if (colon != std::string_view::npos &&
      formats::parse_number<std::uint64_t>(text.substr(colon + 1)) &&
      !std::filesystem::exists(name)) {
    throw formats::UserError(name + ": no such scenario; there are " + scenario_names());
  }
  return load_world(name);
}

}  // namespace nodmap::sim
