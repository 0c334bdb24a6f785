// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/tour.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

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

/// The length of the path between neighbours in a tour; without a stop: its start or its end.
double leg_m(const TourProblem& problem, std::optional<std::size_t> from,
             std::optional<std::size_t> to) {
  if (from && to) {
    return problem.between[*from][*to];
  }
  return from ? problem.to_end[*from] : to ? problem.from_start[*to] : problem.from_start_to_end;
}

/// The part of a tour, first and end, that weighs least compared with the length it costs; empty if
/// every part weighs enough.
std::pair<std::size_t, std::size_t> worst_detour(const TourProblem& problem,
                                                 double min_weight_per_m, double always_weight,
                                                 const std::vector<std::size_t>& order) {
  std::pair<std::size_t, std::size_t> worst{0, 0};
  double least_surplus = 0.0;
  const auto stop = [&](std::size_t i) {
    return i < order.size() ? std::optional(order[i]) : std::nullopt;
  };
  for (std::size_t first = 0; first < order.size(); ++first) {
    const std::optional<std::size_t> before = first > 0 ? stop(first - 1) : std::nullopt;
    double weight = 0.0;
    double length_m = leg_m(problem, before, stop(first));
    for (std::size_t end = first + 1; end <= order.size(); ++end) {
      weight += problem.weight[order[end - 1]];
      const double with_m = length_m + leg_m(problem, stop(end - 1), stop(end));
      const double saved_m = with_m - leg_m(problem, before, stop(end));
      const double surplus = weight - min_weight_per_m * saved_m;
      if (weight < always_weight && surplus < least_surplus) {
        least_surplus = surplus;
        worst = {first, end};
      }
      length_m = with_m;
    }
  }
  return worst;
}

}  // namespace

void leave_out_detours(const TourProblem& problem, double min_weight_per_m, double always_weight,
                       std::vector<std::size_t>& order) {
  while (true) {
    const auto [first, end] = worst_detour(problem, min_weight_per_m, always_weight, order);
    if (first == end) {
      return;
    }
    order.erase(order.begin() + static_cast<std::ptrdiff_t>(first),
                order.begin() + static_cast<std::ptrdiff_t>(end));
  }
}

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
