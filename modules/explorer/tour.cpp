// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/tour.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>

namespace nodmap::explorer {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The cheapest visit of a set of stops with a given last stop.
struct Partial {
  double cost = kInfinity;
  std::size_t before = 0;  // the stop before the last
};

/// For each set of visited stops, the cost per metre.
std::vector<double> weights_by_subset(const TourProblem& problem) {
  const std::size_t n = problem.weight.size();
  std::vector<double> weights(std::size_t{1} << n, problem.length_weight);
  for (std::size_t visited = 0; visited < weights.size(); ++visited) {
    for (std::size_t stop = 0; stop < n; ++stop) {
      if ((visited >> stop & 1U) == 0) {
        weights[visited] += problem.weight[stop];
      }
    }
  }
  return weights;
}

}  // namespace

Tour shortest_tour(const TourProblem& problem, std::optional<std::size_t> first) {
  const std::size_t n = problem.weight.size();
  if (n > kMaxStops) {
    throw std::invalid_argument("too many stops for a tour");
  }
  if (n == 0) {
    return {};
  }
  const std::vector<double> weight = weights_by_subset(problem);
  std::vector<Partial> best(weight.size() * n);
  const auto at = [&](std::size_t visited, std::size_t last) -> Partial& {
    return best[visited * n + last];
  };
  for (std::size_t stop = 0; stop < n; ++stop) {
    if (!first || *first == stop) {
      at(std::size_t{1} << stop, stop).cost = weight[0] * problem.from_start[stop];
    }
  }
  for (std::size_t visited = 1; visited < weight.size(); ++visited) {
    for (std::size_t last = 0; last < n; ++last) {
      const double cost = at(visited, last).cost;
      for (std::size_t next = 0; next < n && cost < kInfinity; ++next) {
        if ((visited >> next & 1U) != 0) {
          continue;
        }
        Partial& extended = at(visited | std::size_t{1} << next, next);
        const double extended_cost = cost + weight[visited] * problem.between[last][next];
        if (extended_cost < extended.cost) {
          extended = {extended_cost, last};
        }
      }
    }
  }
  const std::size_t all = weight.size() - 1;
  Tour tour{.order = std::vector<std::size_t>(n), .cost = kInfinity};
  for (std::size_t last = 0; last < n; ++last) {
    const double cost = at(all, last).cost + weight[all] * problem.to_end[last];
    if (cost < tour.cost) {
      tour.cost = cost;
      tour.order[n - 1] = last;
    }
  }
  std::size_t visited = all;
  for (std::size_t i = n - 1; i > 0; --i) {
    const std::size_t last = tour.order[i];
    tour.order[i - 1] = at(visited, last).before;
    visited ^= std::size_t{1} << last;
  }
  return tour;
}

}  // namespace nodmap::explorer
