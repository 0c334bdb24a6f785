// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace nodmap::geometry {

/// How many whole steps fit into a length. A multiple of the step counts in full although the
/// division rounds: 0.3 / 0.05 is less than 6.
[[nodiscard]] inline int whole_steps(double length, double step) {
  constexpr double kRounding = 1e-6;  // steps
  return static_cast<int>(std::floor(length / step + kRounding));
}

}  // namespace nodmap::geometry
