// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "modules/slam2d/correlative_matcher.hpp"

namespace nodmap::slam2d {

/// Where a scan fits best of some places, and how well it fits elsewhere.
struct BestPlace {
  std::size_t index = 0;
  double score = 0.0;            ///< 0..1
  double runner_up_score = 0.0;  ///< at any other place; 0: there is none

  /// Whether what is missing to a score of 1 elsewhere is at least `min_misfit_ratio` times what is
  /// missing here.
  [[nodiscard]] bool is_clear(double min_misfit_ratio) const;
};

/// Whether two poses are nearer to each other than places that are told apart: 0.5 m and 0.2 rad.
[[nodiscard]] bool is_same_place(const geometry::SE2& a, const geometry::SE2& b);

/// Of some places, at least one.
[[nodiscard]] BestPlace best_of(std::span<const Peak> places);

}  // namespace nodmap::slam2d
