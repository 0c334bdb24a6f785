// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/tour.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

namespace nodmap::explorer {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A stop's bit in a set of stops.
std::size_t bit(std::size_t stop) {
  return std::size_t{1} << stop;
}

// For each set of visited stops, the cost per metre.
std::vector<double> costs_per_m(const TourProblem& problem) {
  const std::size_t n = problem.weight.size();
  std::vector<double> costs(bit(n), problem.length_weight);
  for (std::size_t visited = 0; visited < costs.size(); ++visited) {
    for (std::size_t stop = 0; stop < n; ++stop) {
      if ((visited & bit(stop)) == 0) {
        costs[visited] += problem.weight[stop];
      }
    }
  }
  return costs;
}

// The dynamic programme: the cheapest visit of every set of stops with every last stop.
class PartialTours {
 public:
  PartialTours(const TourProblem& problem, std::optional<std::size_t> first)
      : problem_(problem),
        n_(problem.weight.size()),
        costs_per_m_(costs_per_m(problem)),
        partials_(costs_per_m_.size() * n_) {
    for (std::size_t stop = 0; stop < n_; ++stop) {
      if (!first || *first == stop) {
        at(bit(stop), stop).cost = costs_per_m_[0] * problem.from_start_m[stop];
      }
    }
    for (std::size_t visited = 1; visited < costs_per_m_.size(); ++visited) {
      for (std::size_t last = 0; last < n_; ++last) {
        extend(visited, last);
      }
    }
  }

  // The cheapest tour over all stops.
  [[nodiscard]] Tour cheapest() const {
    std::size_t visited = costs_per_m_.size() - 1;
    Tour tour{.order = std::vector<std::size_t>(n_), .cost = kInfinity};
    for (std::size_t last = 0; last < n_; ++last) {
      const double cost = at(visited, last).cost + costs_per_m_[visited] * problem_.to_end_m[last];
      if (cost < tour.cost) {
        tour.cost = cost;
        tour.order[n_ - 1] = last;
      }
    }
    for (std::size_t i = n_ - 1; i > 0; --i) {
      const std::size_t last = tour.order[i];
      tour.order[i - 1] = at(visited, last).before;
      visited -= bit(last);
    }
    return tour;
  }

 private:
  struct Partial {
    double cost = kInfinity;
    std::size_t before = 0;  // the stop before the last
  };

  [[nodiscard]] Partial& at(std::size_t visited, std::size_t last) {
    return partials_[visited * n_ + last];
  }
  [[nodiscard]] const Partial& at(std::size_t visited, std::size_t last) const {
    return partials_[visited * n_ + last];
  }

  // Goes on from a partial tour to each stop that is not in it.
  void extend(std::size_t visited, std::size_t last) {
    const double cost = at(visited, last).cost;
    for (std::size_t next = 0; next < n_ && cost < kInfinity; ++next) {
      if ((visited & bit(next)) != 0) {
        continue;
      }
      Partial& extended = at(visited | bit(next), next);
      const double extended_cost = cost + costs_per_m_[visited] * problem_.between_m[last][next];
      if (extended_cost < extended.cost) {
        extended = {extended_cost, last};
      }
    }
  }

  const TourProblem& problem_;
  std::size_t n_;
  std::vector<double> costs_per_m_;  // for each set of visited stops
  std::vector<Partial> partials_;
};

// The length of the path between neighbours in a tour; without a stop: its start or its end.
double leg_m(const TourProblem& problem, std::optional<std::size_t> from,
             std::optional<std::size_t> to) {
  if (from && to) {
    return problem.between_m[*from][*to];
  }
  return from ? problem.to_end_m[*from]
         : to ? problem.from_start_m[*to]
              : problem.from_start_to_end_m;
}

// The part of a tour, the stops from first to before end, that weighs least relative to the length
// it costs; empty if every part weighs enough.
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
  if (problem.weight.size() > kMaxStops) {
    throw std::invalid_argument("too many stops for a tour");
  }
  return problem.weight.empty() ? Tour{} : PartialTours(problem, first).cheapest();
}

}  // namespace nodmap::explorer
