// SPDX-License-Identifier: BSD-3-Clause
// Measures the time for one decision of the navigator on a full map of 361 points, by Steer, Brake
// and Turn or by plan and rollouts, and for one scan in the local map. The counters are percentiles
// and the maximum over single decisions or scans (us), in CPU time of the thread, which other load
// on the machine hardly affects.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "bench/timing.hpp"
#include "common/statistics/quantile.hpp"
#include "modules/navigator/navigator.hpp"
#include "modules/navigator/planner/map_2d.hpp"

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
  return 1e3 * bench::thread_cpu_ms();
}

// Reports percentiles of single durations as counters.
void report(benchmark::State& state, const std::vector<double>& durations_us) {
  state.counters["p50_us"] = statistics::quantile(durations_us, 0.50);
  state.counters["p99_us"] = statistics::quantile(durations_us, 0.99);
  state.counters["max_us"] = statistics::quantile(durations_us, 1.0);
}

// A sweep of 40 scans of 181 beams over a flat floor with a pillar every 20 beams.
std::vector<scan::Scan> sweep() {
  std::vector<scan::Scan> scans;
  for (double deg = -40.0; deg < 10.0; deg += 1.25) {
    scan::Scan scan;
    scan.angle_first_rad = -0.5 * geometry::kPi;
    scan.angle_step_rad = geometry::deg_to_rad(1.0);
    scan.pitch_first_rad = scan.pitch_last_rad = geometry::deg_to_rad(deg);
    scan.range_min_m = 0.05;
    scan.range_max_m = 80.0;
    scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, 0.38);
    for (int beam = 0; beam < 181; ++beam) {
      const Eigen::Vector3d ray = scan::beam_direction(
          scan.angle_first_rad + beam * scan.angle_step_rad, scan.pitch_first_rad);
      const double to_floor_m = ray.z() < 0.0 ? -0.38 / ray.z() : 80.0;
      const double to_pillar_m = beam % 20 < 3 ? 1.0 + 0.01 * beam : 6.0;
      scan.ranges_m.push_back(static_cast<float>(std::min(to_floor_m, to_pillar_m)));
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

// Adds one scan to the local map, while the robot drives at 1 m/s.
void LocalMapScan(benchmark::State& state) {
  const std::vector<scan::Scan> scans = sweep();
  LocalMap map({}, {});
  std::vector<double> scan_us;
  scan_us.reserve(1U << 20U);
  std::size_t i = 0;
  for (auto _ : state) {
    const geometry::SE2 T_odom_base{0.013 * static_cast<double>(i), 0.0, 0.0};
    const double start_us = cpu_us();
    map.add_scan(scans[i++ % scans.size()], T_odom_base);
    scan_us.push_back(cpu_us() - start_us);
  }
  report(state, std::move(scan_us));
}

// Measures decisions, 75 a second, from `start` on.
void measure(benchmark::State& state, Navigator& navigator, const Points& points,
             const std::optional<Eigen::Vector2d>& goal_base, time::Timestamp start = {},
             const Map2d* map_2d = nullptr) {
  std::vector<double> decision_us;
  decision_us.reserve(1U << 20U);
  Situation now;
  now.stamp = start;
  now.map_2d = map_2d;
  now.max_forward_mps = 1.5;
  now.forward_mps = 0.5;
  now.yaw_rate_rad_s = 0.3;
  for (auto _ : state) {
    now.stamp += 13'320us;
    now.sweep_count = now.stamp.time_since_epoch() / 350ms;
    if (goal_base) {
      now.goal = GoalInBase{*goal_base, 0.2};
    }
    const double start_us = cpu_us();
    now.points_base = move_to_base(points, {}, {0.02, 0.0, 0.01});
    benchmark::DoNotOptimize(navigator.decide(now));
    decision_us.push_back(cpu_us() - start_us);
  }
  report(state, std::move(decision_us));
}

// `scans` are the input of the local map; if there are none, the paper's behaviours drive.
void decide(benchmark::State& state, const Points& points, bool has_goal,
            const std::vector<scan::Scan>& scans = {}) {
  Navigator navigator{{}};
  for (int i = 0; i < 4; ++i) {
    for (const scan::Scan& scan : scans) {
      navigator.add_scan(scan, {});
    }
  }
  measure(state, navigator, points,
          has_goal ? std::optional(Eigen::Vector2d(5.0, 1.0)) : std::nullopt);
}

// To a goal 18 m away, on a plan that covers 51 m x 51 m: the robot has looked around every 8 m.
void ToAGoalInAKnownBuilding(benchmark::State& state) {
  const Eigen::Vector2d goal_odom(15.0, 10.0);
  const std::vector<scan::Scan> scans = sweep();
  Navigator navigator{{}};
  Situation now;
  now.max_forward_mps = 1.5;
  const auto look_from = [&](double x, double y) {
    now.T_odom_base = {x, y, 0.0};
    for (const scan::Scan& scan : scans) {
      navigator.add_scan(scan, now.T_odom_base);
    }
    // With each new goal the planner takes over what the local map has seen.
    now.stamp += 1s;
    now.sweep_count += 2;
    now.goal = GoalInBase{{2.0, 0.0}, 0.2};  // in odom another one at each place
    benchmark::DoNotOptimize(navigator.decide(now));
  };
  for (double x = -24.0; x <= 24.0; x += 8.0) {
    for (double y = -24.0; y <= 24.0; y += 8.0) {
      look_from(x, y);
    }
  }
  look_from(0.0, 0.0);
  measure(state, navigator, full_map(1.0, 4.0), goal_odom, now.stamp);
}

// The same goal with a 2D map of 102 m x 102 m of rooms of 6.4 m with doors, of which the local map
// has shown only the first. Its plan covers 51 m x 51 m as well.
void ToAGoalOnA2dMap(benchmark::State& state) {
  constexpr int kTile = 128;
  std::vector<std::int8_t> room(std::size_t{kTile} * kTile, 0);
  for (int i = 0; i < kTile; ++i) {
    const bool is_door = i >= 56 && i < 76;
    room[static_cast<std::size_t>(i)] = room[static_cast<std::size_t>(kTile * i)] =
        is_door ? std::int8_t{0} : std::int8_t{100};
  }
  Map2d map;
  for (int row = -8; row < 8; ++row) {
    for (int column = -8; column < 8; ++column) {
      const Eigen::Vector2i first(kTile * column + kTile / 2, kTile * row + kTile / 2);
      static_cast<void>(map.add({0.05, first, kTile, kTile, room}));
    }
  }
  Navigator navigator{{}};
  for (int i = 0; i < 4; ++i) {
    for (const scan::Scan& scan : sweep()) {
      navigator.add_scan(scan, {});
    }
  }
  measure(state, navigator, full_map(1.0, 4.0), Eigen::Vector2d(15.0, 10.0), {}, &map);
}

// Adds a tile of 2D SLAM to the 2D map.
void A2dMapTile(benchmark::State& state) {
  const std::vector<std::int8_t> cells(std::size_t{128} * 128, 0);
  Map2d map;
  for (auto _ : state) {
    benchmark::DoNotOptimize(map.add({0.05, {0, 0}, 128, 128, cells}));
  }
}

// Before the edge of a dock 0.9 m ahead, at which the robot has looked from all sides, by its
// fastest speed in tenths of a metre per second: the distance within which holes count grows with
// its square.
void BeforeAnEdge(benchmark::State& state) {
  NavigatorParams params;
  params.drive.max_forward_mps = 0.1 * static_cast<double>(state.range(0));
  Navigator navigator(params);
  for (int turn = -6; turn <= 6; ++turn) {
    const geometry::SE2 T_odom_base{0.0, 0.0, 0.2 * turn};
    for (double deg = -60.0; deg <= -2.0; deg += 1.0) {
      scan::Scan scan = sweep().front();
      scan.pitch_first_rad = scan.pitch_last_rad = geometry::deg_to_rad(deg);
      const geometry::SE3 T_odom_mount = geometry::to_se3(T_odom_base) * scan.T_base_mount;
      for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
        const Eigen::Vector3d ray =
            T_odom_mount.linear() *
            scan::beam_direction(scan.angle_rad(beam), scan.pitch_first_rad);
        const double to_floor_m = -0.38 / ray.z();
        const bool is_floor = T_odom_mount.translation().x() + to_floor_m * ray.x() < 0.9;
        scan.ranges_m[beam] = static_cast<float>(is_floor ? to_floor_m : -1.38 / ray.z());
      }
      navigator.add_scan(scan, T_odom_base);
    }
  }
  measure(state, navigator, full_map(1.0, 4.0), Eigen::Vector2d(5.0, 1.0));
}

void Roaming(benchmark::State& state) {
  decide(state, full_map(1.0, 4.0), false);
}
void RoamingByPlan(benchmark::State& state) {
  decide(state, full_map(1.0, 4.0), false, sweep());
}
void ToAGoal(benchmark::State& state) {
  decide(state, full_map(1.0, 4.0), true);
}
void ToAGoalByPlan(benchmark::State& state) {
  decide(state, full_map(1.0, 4.0), true, sweep());
}
void ObstaclesAllAround(benchmark::State& state) {
  decide(state, full_map(0.3, 0.6), false);
}

BENCHMARK(Roaming);
BENCHMARK(RoamingByPlan);
BENCHMARK(ToAGoal);
BENCHMARK(ToAGoalByPlan);
BENCHMARK(ToAGoalInAKnownBuilding)->Iterations(3000);
BENCHMARK(ToAGoalOnA2dMap)->Iterations(3000);
BENCHMARK(A2dMapTile);
BENCHMARK(LocalMapScan);
BENCHMARK(ObstaclesAllAround);
BENCHMARK(BeforeAnEdge)->Arg(15)->Arg(50);

}  // namespace
}  // namespace nodmap::navigator
