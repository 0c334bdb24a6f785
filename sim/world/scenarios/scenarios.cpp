// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/scenarios/scenarios.hpp"

#include <array>

#include "sim/world/random_world.hpp"

namespace nodmap::sim {
namespace {

constexpr std::array kScenarios{
    Scenario{"building", "ten rooms on a corridor, to explore", make_building},
    Scenario{"contact", "a table top of glass on the path", make_contact},
    Scenario{"corridor", "100 m, boxes of 10 cm", make_corridor},
    Scenario{"dead-end", "0.7 m wide", make_dead_end},
    Scenario{"dense", "clutter to roam in, passages of 0.5 m", dense_clutter},
    Scenario{"dock", "clutter with a goal to dock at", clutter_with_dock},
    Scenario{"doors", "0.55 to 0.6 m wide, aside of the path", make_doors},
    Scenario{"drums", "of 12 and 16 cm, passed closely", make_drums},
    Scenario{"glass", "panes that return no light", make_glass},
    Scenario{"goals", "dense clutter with a goal", clutter_with_goal},
    Scenario{"holes", "stairs down, shaft, trench, pits, kerb, dock edge", make_holes},
    Scenario{"maze", "loops and dead ends", make_maze},
    Scenario{"office", "ten rooms on a corridor, a goal in one", make_office},
    Scenario{"people", "who do not react", make_people},
    Scenario{"ramps", "5, 10 and 12 degrees, up, over and down", make_ramps},
    Scenario{"random", "clutter to roam in, passages of 0.6 m", random_clutter},
    Scenario{"reacting", "people who make way", make_reacting_people},
    Scenario{"sills", "and planks of 3.1 to 6 cm", make_sills},
    Scenario{"slot", "start in a slot or a corner", make_slot},
    Scenario{"zigzag", "corridor with baffles", make_zigzag},
};

}  // namespace

std::span<const Scenario> scenarios() {
  return kScenarios;
}

std::string scenario_names() {
  std::string names;
  for (const Scenario& scenario : kScenarios) {
    names += (names.empty() ? "" : ", ") + std::string(scenario.name);
  }
  return names;
}

}  // namespace nodmap::sim
