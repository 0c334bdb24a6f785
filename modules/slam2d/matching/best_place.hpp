// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "modules/slam2d/matching/correlative_match.hpp"

namespace nodmap::slam2d {

/// The place among several at which a scan fits best, and how well it fits elsewhere.
struct BestPlace {
  std::size_t index = 0;
  double score = 0.0;            ///< 0..1
  double runner_up_score = 0.0;  ///< at any other place; 0: there is none

  /// Whether the misfit (1 - score) at every other place is at least `min_misfit_ratio` times the
  /// misfit here, plus a margin of 0.02.
  [[nodiscard]] bool is_clear(double min_misfit_ratio) const;
};

/// Whether two poses count as the same place: less than 0.5 m and 0.2 rad apart.
[[nodiscard]] bool is_same_place(const geometry::SE2& a, const geometry::SE2& b);

/// Returns the best of `places`, which must not be empty.
[[nodiscard]] BestPlace best_of(std::span<const Peak> places);

}  // namespace nodmap::slam2d
