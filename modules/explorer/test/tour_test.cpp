// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/tour.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

namespace nodmap::explorer {
namespace tour_test {

// Random stops in a square, with straight lines between them and back to the start.
TourProblem random_problem(std::size_t num_stops, double length_weight, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place(0.0, 10.0);
  std::vector<Eigen::Vector2d> stops;
  TourProblem problem;
  problem.length_weight = length_weight;
  for (std::size_t i = 0; i < num_stops; ++i) {
    stops.emplace_back(place(engine), place(engine));
    problem.weight.push_back(place(engine));
    problem.from_start_m.push_back(stops.back().norm());
    problem.to_end_m.push_back(stops.back().norm());
  }
  for (const Eigen::Vector2d& a : stops) {
    problem.between_m.emplace_back();
    for (const Eigen::Vector2d& b : stops) {
      problem.between_m.back().push_back((a - b).norm());
    }
  }
  return problem;
}

double cost_of(const TourProblem& problem, const std::vector<std::size_t>& order) {
  double waiting = std::accumulate(problem.weight.begin(), problem.weight.end(), 0.0);
  double cost = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double length_m =
        i == 0 ? problem.from_start_m[order[0]] : problem.between_m[order[i - 1]][order[i]];
    cost += (problem.length_weight + waiting) * length_m;
    waiting -= problem.weight[order[i]];
  }
  return cost + problem.length_weight * problem.to_end_m[order.back()];
}

class ShortestTour : public ::testing::TestWithParam<int> {};

// Oracle: all orders of seven stops.
TEST_P(ShortestTour, IsTheBestOfAllOrders) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  const TourProblem problem = random_problem(7, seed % 2 == 0 ? 0.0 : 20.0, seed);
  std::vector<std::size_t> order(7);
  std::iota(order.begin(), order.end(), 0U);
  double least = cost_of(problem, order);
  double least_from_3 = 1e9;
  while (std::next_permutation(order.begin(), order.end())) {
    least = std::min(least, cost_of(problem, order));
    least_from_3 = order[0] == 3 ? std::min(least_from_3, cost_of(problem, order)) : least_from_3;
  }
  const Tour tour = shortest_tour(problem);
  // The same numbers are added in another order.
  EXPECT_NEAR(tour.cost, least, 1e-9 * least);
  EXPECT_NEAR(cost_of(problem, tour.order), tour.cost, 1e-9 * least);
  const Tour from_3 = shortest_tour(problem, 3);
  EXPECT_EQ(from_3.order.front(), 3U);
  EXPECT_NEAR(from_3.cost, least_from_3, 1e-9 * least_from_3);
}
INSTANTIATE_TEST_SUITE_P(Seeds, ShortestTour, ::testing::Range(0, 6));

TEST(ShortestTourDegenerate, HandlesNoStopOneStopAndTooManyStops) {
  EXPECT_TRUE(shortest_tour({}).order.empty());
  const Tour one = shortest_tour(random_problem(1, 1.0, 1));
  EXPECT_EQ(one.order, std::vector<std::size_t>{0});
  EXPECT_EQ(shortest_tour(random_problem(kMaxStops, 1.0, 1)).order.size(), kMaxStops);
  EXPECT_THROW((void)shortest_tour(random_problem(kMaxStops + 1, 1.0, 1)), std::invalid_argument);
}

// What a part of a tour, from `first` to `end`, weighs, and how much shorter the tour is without
// it.
std::pair<double, double> part_of(const TourProblem& problem, const std::vector<std::size_t>& order,
                                  std::size_t first, std::size_t end) {
  const auto length_m = [&](const std::vector<std::size_t>& stops) {
    double sum_m = stops.empty()
                       ? problem.from_start_to_end_m
                       : problem.from_start_m[stops.front()] + problem.to_end_m[stops.back()];
    for (std::size_t i = 1; i < stops.size(); ++i) {
      sum_m += problem.between_m[stops[i - 1]][stops[i]];
    }
    return sum_m;
  };
  std::vector<std::size_t> without = order;
  double weight = 0.0;
  for (std::size_t i = first; i < end; ++i) {
    weight += problem.weight[order[i]];
  }
  without.erase(without.begin() + static_cast<std::ptrdiff_t>(first),
                without.begin() + static_cast<std::ptrdiff_t>(end));
  return {weight, length_m(order) - length_m(without)};
}

class Detours : public ::testing::TestWithParam<int> {};

// Oracle: computes the length of the whole tour with and without each part, and leaves out the
// worst part in every step.
TEST_P(Detours, TheWorstPartIsLeftOutUntilEachPartIsWorthItsWay) {
  constexpr double kMinPerM = 1.5;
  constexpr double kAlways = 12.0;
  const TourProblem problem = random_problem(8, 0.0, static_cast<std::uint64_t>(GetParam()));
  const std::vector<std::size_t> all = shortest_tour(problem).order;
  std::vector<std::size_t> expected = all;
  while (true) {
    std::pair<std::size_t, std::size_t> worst{0, 0};
    double least_surplus = -1e-9;  // rounding: the same lengths are added in another order
    for (std::size_t first = 0; first < expected.size(); ++first) {
      for (std::size_t end = first + 1; end <= expected.size(); ++end) {
        const auto [weight, saved_m] = part_of(problem, expected, first, end);
        if (weight < kAlways && weight - kMinPerM * saved_m < least_surplus) {
          least_surplus = weight - kMinPerM * saved_m;
          worst = {first, end};
        }
      }
    }
    if (worst.first == worst.second) {
      break;
    }
    expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(worst.first),
                   expected.begin() + static_cast<std::ptrdiff_t>(worst.second));
  }
  std::vector<std::size_t> order = all;
  leave_out_detours(problem, kMinPerM, kAlways, order);
  EXPECT_EQ(order, expected);
  order = all;
  leave_out_detours(problem, 0.0, kAlways, order);
  EXPECT_EQ(order, all) << "no way is too long for no gain";
  leave_out_detours(problem, 1e9, 0.0, order);
  EXPECT_EQ(order, all) << "all parts weigh enough";
}
INSTANTIATE_TEST_SUITE_P(Seeds, Detours, ::testing::Range(0, 6));

// Two stops side by side, 10 m off the way. Without one of them the tour is hardly shorter, without
// both it is 20 m shorter.
TEST(Detour, StopsThatShareADetourAreLeftOutTogether) {
  TourProblem problem;
  problem.weight = {1.0, 1.0};
  problem.from_start_m = {10.0, 10.0};
  problem.to_end_m = {10.0, 10.0};
  problem.between_m = {{0.0, 0.1}, {0.1, 0.0}};
  problem.from_start_to_end_m = 0.0;
  std::vector<std::size_t> order{0, 1};
  leave_out_detours(problem, 0.09, 4.0, order);  // 2 / 20.1 = 0.0995
  EXPECT_EQ(order.size(), 2U);
  leave_out_detours(problem, 0.11, 2.0, order);
  EXPECT_EQ(order.size(), 2U) << "together they are worth any way";
  leave_out_detours(problem, 0.11, 4.0, order);
  EXPECT_TRUE(order.empty());
  leave_out_detours(problem, 0.11, 4.0, order);
  EXPECT_TRUE(order.empty());
}

}  // namespace tour_test
}  // namespace nodmap::explorer
