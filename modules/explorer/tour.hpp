// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace nodmap::explorer {

/// The stops of a tour, and the costs between them in metres of driving: the lengths of the paths,
/// and what else takes as long as driving that far.
struct TourProblem {
  std::vector<double> weight;        ///< of each stop
  std::vector<double> from_start_m;  ///< from the start to each stop
  std::vector<double> to_end_m;      ///< from each stop to the end of the tour
  std::vector<std::vector<double>> between_m;
  double from_start_to_end_m = 0.0;  ///< without any stop
  double length_weight = 0.0;        ///< weight of the total length
};

struct Tour {
  std::vector<std::size_t> order;  ///< indices of the stops
  double cost = 0.0;
};

/// Greatest number of stops, because each one doubles the computing time.
inline constexpr std::size_t kMaxStops = 12;

/// The tour of least cost over all stops; with `first`, the cheapest of those that start with this
/// stop. Each metre costs the weight of the length plus the weights of all stops not yet visited,
/// so that heavy stops are visited early: a mix of travelling salesman and travelling repairman.
/// Exact, by dynamic programming over the subsets of stops (Held and Karp 1962). Throws
/// std::invalid_argument beyond kMaxStops.
[[nodiscard]] Tour shortest_tour(const TourProblem& problem,
                                 std::optional<std::size_t> first = std::nullopt);

/// Removes parts of a tour, each a run of successive stops, the worst first: those whose stops
/// together weigh less than `min_weight_per_m` for each metre that leaving them out saves. Parts
/// that weigh `always_weight` or more stay.
void leave_out_detours(const TourProblem& problem, double min_weight_per_m, double always_weight,
                       std::vector<std::size_t>& order);

}  // namespace nodmap::explorer
