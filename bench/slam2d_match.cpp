// SPDX-License-Identifier: BSD-3-Clause
// Measures the time of 2D SLAM's scan matching alone. Each keyframe is matched with a submap of the
// twenty keyframes before it, starting from its pose by odometry. Call (DIR is the output folder of
// nodmap-slam2d --out):
//   nodmap-bench-slam2d-match DIR
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "common/statistics/quantile.hpp"
#include "modules/slam2d/back_end/saved_map_file.hpp"
#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"

namespace {

using namespace nodmap::slam2d;
using nodmap::bench::process_cpu_ms;
using nodmap::geometry::SE2;
using nodmap::statistics::quantile;

constexpr std::size_t kKeyframes = 20;

// The submap of the keyframes before `keyframe`.
Submap submap_before(const std::vector<Keyframe>& keyframes, std::size_t keyframe) {
  const std::size_t first = keyframe - kKeyframes;
  Submap submap(first, keyframes[first].T_map_base, {});
  for (std::size_t k = first; k < keyframe; ++k) {
    submap.add(submap.T_map_submap.inverse() * keyframes[k].T_map_base,
               oriented_points(keyframes[k]));
  }
  return submap;
}

void measure(const std::vector<Keyframe>& keyframes) {
  const ScanMatcher matcher{MatcherParams{}};
  std::vector<double> times_ms;
  std::vector<double> num_points;
  for (std::size_t k = kKeyframes; k < keyframes.size(); ++k) {
    const Submap submap = submap_before(keyframes, k);
    const std::vector<OrientedPoint> scan = oriented_points(keyframes[k]);
    const SE2 step = keyframes[k - 1].T_odom_base.inverse() * keyframes[k].T_odom_base;
    const SE2 guess = submap.T_map_submap.inverse() * keyframes[k - 1].T_map_base * step;
    const double begin_ms = process_cpu_ms();
    (void)matcher.match(submap.points, scan, guess);
    times_ms.push_back(process_cpu_ms() - begin_ms);
    num_points.push_back(static_cast<double>(scan.size()));
  }
  std::printf("%zu matches of %.0f points (median): p50 %.3f ms, p90 %.3f ms, p99 %.3f ms\n",
              times_ms.size(), quantile(num_points, 0.5), quantile(times_ms, 0.5),
              quantile(times_ms, 0.9), quantile(times_ms, 0.99));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Measures how long a scan is matched with the map that the other keyframes make.");
    std::string dir;
    app.add_option("DIR", dir, "a saved map of 2D SLAM")->required()->check(CLI::ExistingDirectory);
    CLI11_PARSE(app, argc, argv);
    measure(read_saved_map(dir).keyframes);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodmap-bench-slam2d-match: %s\n", error.what());
    return 1;
  }
  return 0;
}
