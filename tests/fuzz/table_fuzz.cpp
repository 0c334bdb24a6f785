// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a file of numbers in lines; the first byte chooses between a TUM trajectory,
// relations, worlds of BARN and recorded pedestrians. The result is what the file says, or an error
// message; a world can be simulated.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include "common/formats/tum.hpp"
#include "sim/world/barn_file.hpp"
#include "sim/world/pedestrian_file.hpp"
#include "tests/fuzz/memory_file.hpp"
#include "tools/evaluate/relations.hpp"

namespace {

namespace fs = std::filesystem;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void read_trajectory(const fs::path& file) {
  for (const auto& stamped : nodmap::formats::read_tum(file)) {
    require(stamped.pose.matrix().allFinite());
  }
}

void read_relations(const fs::path& file) {
  for (const auto& relation : nodmap::evaluate::read_relations(file)) {
    require(relation.T_from_to.matrix().allFinite());
  }
}

void require_finite(const nodmap::sim::World& world) {
  for (const nodmap::sim::Actor& actor : world.actors) {
    for (const nodmap::sim::Waypoint& waypoint : actor.path) {
      require(std::isfinite(waypoint.time_s) && waypoint.position.allFinite());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const nodmap::fuzz::MemoryFile file(data + 1, size - 1);
  try {
    switch (data[0] % 4) {
      case 0:
        read_trajectory(file.path());
        break;
      case 1:
        read_relations(file.path());
        break;
      case 2:
        require_finite(nodmap::sim::load_barn_world(file.path(), 1));
        break;
      default:
        require_finite(nodmap::sim::load_pedestrians(file.path(), 25.0, 1));
    }
  } catch (const std::runtime_error&) {
  }
  return 0;
}
