// SPDX-License-Identifier: BSD-3-Clause
// Time for one decision of the navigator on a full map of 361 points: moving the points, Steer,
// Brake and Turn. Percentiles over single decisions as counters, in microseconds of the thread's
// own processor time: what else the machine does is not in them.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <random>
#include <vector>

#include "modules/navigator/navigator.hpp"

namespace nodmap::navigator {
namespace {

Points full_map(double least_m, double most_m) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> range_m(least_m, most_m);
  Points points;
  for (int degree = -180; degree <= 180; ++degree) {
    const double angle_rad = geometry::deg_to_rad(degree);
    points.emplace_back(range_m(random) *
                        Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  return points;
}

double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

void decide(benchmark::State& state, const Points& points, bool has_goal) {
  Navigator navigator{{}};
  std::vector<double> decision_us;
  decision_us.reserve(1U << 20U);
  Situation now;
  now.max_forward_mps = 1.5;
  now.forward_mps = 0.5;
  now.yaw_rate_rad_s = 0.3;
  for (auto _ : state) {
    now.utime_us += 13'320;
    now.sweep_count = now.utime_us / 350'000;
    if (has_goal) {
      now.goal = goal_in_base({5.0, 1.0}, 0.2);
    }
    const double start_us = cpu_us();
    now.points_base = move_to_base(points, {}, {0.02, 0.0, 0.01});
    benchmark::DoNotOptimize(navigator.decide(now));
    decision_us.push_back(cpu_us() - start_us);
  }
  std::ranges::sort(decision_us);
  const auto percentile = [&](double share) {
    return decision_us[static_cast<std::size_t>(share *
                                                static_cast<double>(decision_us.size() - 1))];
  };
  state.counters["p50_us"] = percentile(0.50);
  state.counters["p99_us"] = percentile(0.99);
}

void Roaming(benchmark::State& state) {
  decide(state, full_map(1.0, 4.0), false);
}
void ToAGoal(benchmark::State& state) {
  decide(state, full_map(1.0, 4.0), true);
}
void ObstaclesAllAround(benchmark::State& state) {
  decide(state, full_map(0.3, 0.6), false);
}

BENCHMARK(Roaming);
BENCHMARK(ToAGoal);
BENCHMARK(ObstaclesAllAround);

}  // namespace
}  // namespace nodmap::navigator
