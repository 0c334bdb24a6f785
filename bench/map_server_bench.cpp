// SPDX-License-Identifier: BSD-3-Clause
// Measures the time to add one scan of 181 beams, including the robot's motion, to both egocentric
// maps together, and to a grid with ray clearing for comparison. The counters are percentiles over
// single scans (us).
#include <benchmark/benchmark.h>

#include <chrono>
#include <vector>

#include "bench/costmap_baseline.hpp"
#include "bench/timing.hpp"
#include "common/statistics/quantile.hpp"
#include "modules/map_server/map_server.hpp"
#include "modules/map_server/test/world.hpp"

namespace nodmap::map_server {
namespace {

using geometry::deg_to_rad;

struct Step {
  scan::Scan scan;
  geometry::SE3 T_odom_base;
};

// A drive through a furnished room: 20 s at 0.3 m/s in a gentle curve.
const std::vector<Step>& drive() {
  static const std::vector<Step> steps = [] {
    test::World world = test::room(-2, 9, -3, 3);
    world.cylinders.push_back({{3.2, -1.5}, 0.25, 1.7});
    world.boxes.push_back({{4.0, 0.8, 0.0}, {4.5, 1.4, 0.4}});
    world.boxes.push_back({{6.0, -0.8, 0.0}, {6.4, -0.4, 0.12}});
    test::NoddingScanner scanner;
    scanner.range_sigma_m = 0.01;
    std::vector<Step> made;
    for (int i = 0; i < 1500; ++i) {
      const double t = i * test::NoddingScanner::kPeriodS;
      const geometry::SE2 pose{0.3 * t, 0.05 * t, 0.1 * std::sin(t)};
      made.push_back({scanner.scan(world, pose), geometry::to_se3(pose)});
    }
    return made;
  }();
  return steps;
}

template <class AddScan>
void time_scans(benchmark::State& state, const AddScan& add_scan) {
  using Clock = std::chrono::steady_clock;
  const auto& steps = drive();
  std::vector<double> scan_us;
  scan_us.reserve(1U << 22U);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto start = Clock::now();
    add_scan(steps[i]);
    scan_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    i = (i + 1) % steps.size();
  }
  state.counters["p50_us"] = statistics::quantile(scan_us, 0.50);
  state.counters["p99_us"] = statistics::quantile(scan_us, 0.99);
}

MapServerParams params_for(const benchmark::State& state, RemovalRule rule) {
  MapServerParams params;
  params.update.rule = rule;
  params.bins.aperture_rad = deg_to_rad(static_cast<double>(state.range(0)));
  params.bins.resolution_rad = deg_to_rad(0.5);
  return params;
}

void VisibilityRuleBothMaps(benchmark::State& state) {
  MapServer server(params_for(state, RemovalRule::kVisibility));
  time_scans(state, [&](const Step& s) { server.add_scan(s.scan, s.T_odom_base); });
  state.counters["bins"] = static_cast<double>(server.obstacle_map().scan().size());
}

void PaperRuleBothMaps(benchmark::State& state) {
  MapServer server(params_for(state, RemovalRule::kPaper));
  time_scans(state, [&](const Step& s) { server.add_scan(s.scan, s.T_odom_base); });
  state.counters["bins"] = static_cast<double>(server.obstacle_map().scan().size());
}

void CostmapOneLayer(benchmark::State& state) {
  bench::CostmapBaseline costmap;
  time_scans(state, [&](const Step& s) { costmap.add_scan(s.scan, s.T_odom_base); });
  benchmark::DoNotOptimize(costmap.occupied());
}

// Apertures of 180 and 360 degrees at half a degree: 361 and 720 bins.
BENCHMARK(VisibilityRuleBothMaps)->Arg(180)->Arg(360);
BENCHMARK(PaperRuleBothMaps)->Arg(180)->Arg(360);
BENCHMARK(CostmapOneLayer);

}  // namespace
}  // namespace nodmap::map_server
