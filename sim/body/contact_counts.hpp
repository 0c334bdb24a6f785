// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace nodmap::sim {

/// How many contacts there have been.
struct ContactCounts {
  std::int64_t collisions = 0;       ///< with obstacles and actors, without bumps
  std::int64_t bumps = 0;            ///< with actors that walked into the stationary robot
  std::int64_t contacts_caused = 0;  ///< collisions while a point of the body moved at >= 0.05 m/s
  std::int64_t falls = 0;            ///< collisions with the edge of a pit or of a platform
};

}  // namespace nodmap::sim
