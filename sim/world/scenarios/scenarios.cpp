// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/scenarios/scenarios.hpp"

#include <array>

#include "sim/world/random_world.hpp"

namespace nodmap::sim {
namespace {

constexpr std::array kScenarios{
    Scenario{"holes", "stairs down, shaft, trench, pits, kerb, dock edge; with a goal", make_holes},
    Scenario{"random", "clutter to roam in, passages of 0.6 m", random_clutter},
};

}  // namespace

std::span<const Scenario> scenarios() {
  return kScenarios;
}

}  // namespace nodmap::sim
