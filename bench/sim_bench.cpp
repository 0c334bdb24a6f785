// SPDX-License-Identifier: BSD-3-Clause
// Measures the time for one simulated scan of 181 beams while the laser nods, and for one second of
// the whole model (1000 steps and 75 scans).
#include <benchmark/benchmark.h>

#include <cmath>

#include "common/geometry/angle.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/world/ray_caster.hpp"
#include "sim/world/world_file.hpp"

namespace nodmap::sim {
namespace {

using geometry::deg_to_rad;

constexpr time::Duration kScanPeriod = 13'320us;

World world(const char* name) {
  return load_world(std::string(NODMAP_SOURCE_DIR "/sim/worlds/") + name + ".yaml");
}

void scan(RobotModel& model, time::SteadyTime end) {
  for (int beam = -90; beam <= 90; ++beam) {
    benchmark::DoNotOptimize(model.measure(deg_to_rad(beam), end - 6'660us + 37us * beam));
  }
}

// The laser nods through the usual sweep while the robot is stationary.
void Scan(benchmark::State& state, const char* name) {
  RobotModel model(world(name), {}, 1);
  time::SteadyTime now{};
  for (auto _ : state) {
    state.PauseTiming();
    now += kScanPeriod;
    model.set_pitch_goal(
        {now.time_since_epoch() / kScanPeriod / 60 % 2 == 0 ? -0.7 : 0.26, 1.2, 40.0});
    model.advance_to(now);
    state.ResumeTiming();
    scan(model, now);
  }
}

// The robot rotates on the spot.
void RobotSecond(benchmark::State& state, const char* name) {
  RobotModel model(world(name), {}, 1);
  model.set_wheel_speeds({-0.3, 0.3});
  time::SteadyTime now{};
  for (auto _ : state) {
    for (int i = 0; i < 75; ++i) {
      now += kScanPeriod;
      model.set_pitch_goal(
          {now.time_since_epoch() / kScanPeriod / 60 % 2 == 0 ? -0.7 : 0.26, 1.2, 40.0});
      model.advance_to(now);
      scan(model, now);
    }
  }
}

BENCHMARK_CAPTURE(Scan, office, "office")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Scan, cellar, "cellar")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Scan, crowd, "crowd")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(RobotSecond, office, "office")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(RobotSecond, crowd, "crowd")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nodmap::sim
