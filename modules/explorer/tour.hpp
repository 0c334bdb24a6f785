// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace nodmap::explorer {

/// The stops of a tour, and the lengths of the paths between them, metres.
struct TourProblem {
  std::vector<double> weight;      ///< of each stop
  std::vector<double> from_start;  ///< length from the start to each stop
  std::vector<double> to_end;      ///< from each stop to where the tour ends
  std::vector<std::vector<double>> between;
  double length_weight = 0.0;  ///< of the whole length
};

struct Tour {
  std::vector<std::size_t> order;  ///< of the stops
  double cost = 0.0;
};

/// More stops than this are refused: the cost doubles with each.
inline constexpr std::size_t kMaxStops = 12;

/// The tour of least cost over all stops, or of those that begin with the stop `first`. Each metre
/// costs the length's weight and that of all stops still to come, so that what weighs much is
/// visited early: a mix of travelling salesman and travelling repairman. Exact, by dynamic
/// programming over the subsets of stops (Held and Karp 1962). Throws std::invalid_argument beyond
/// kMaxStops.
[[nodiscard]] Tour shortest_tour(const TourProblem& problem,
                                 std::optional<std::size_t> first = std::nullopt);

}  // namespace nodmap::explorer
