// SPDX-License-Identifier: BSD-3-Clause
// Measures the time to insert one sweep of a nodding scanner (81 lines of 181 beams) into an
// OctoMap of 5 cm voxels: OctoMap's insertPointCloud() compared with ours. The maps are filled by a
// drive of ten sweeps.
#include <benchmark/benchmark.h>
#include <octomap/octomap.h>

#include <random>
#include <vector>

#include "modules/slam6d/occupancy_map.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace {

constexpr int kSweeps = 10;
constexpr int kScansPerSweep = 81;

struct PlacedCloud {
  SweepCloud cloud;
  geometry::SE3 T_map_base;
};

// Ten sweeps, 0.5 m apart, through a hall of 10 m x 2 m; the robot is stationary during each.
const std::vector<PlacedCloud>& drive() {
  static const std::vector<PlacedCloud> clouds = [] {
    std::mt19937 random(50);
    const NoddingScanner scanner{.noise_m = 0.01};
    std::vector<PlacedCloud> made;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      geometry::SE3 T_map_base = geometry::SE3::Identity();
      T_map_base.translation().x() = 0.5 * sweep - 2.5;
      std::vector<scan::Scan> scans;
      scans.reserve(kScansPerSweep);
      for (int i = 0; i < kScansPerSweep; ++i) {
        scans.push_back(scanner.scan(
            i, Room::hall(), [&](time::Timestamp) { return T_map_base; }, random));
      }
      const auto stand = [](time::Timestamp) { return geometry::SE3::Identity(); };
      made.push_back({deskew(scans, stand, {0.5, 30.0}).value(), T_map_base});
    }
    return made;
  }();
  return clouds;
}

octomap::point3d to_octomap(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

void insert_stock(octomap::OcTree& tree, const PlacedCloud& placed) {
  octomap::Pointcloud points;
  for (const Eigen::Vector3f& p : placed.cloud.points) {
    points.push_back(to_octomap(placed.T_map_base * p.cast<double>()));
  }
  const Eigen::Vector3d p_base_origin = placed.cloud.lines.front().p_base_mirror.cast<double>();
  tree.insertPointCloud(points, to_octomap(placed.T_map_base * p_base_origin), 10.0);
}

void Stock(benchmark::State& state) {
  const std::vector<PlacedCloud>& clouds = drive();  // made here, in nobody's time
  for (auto _ : state) {
    octomap::OcTree tree(0.05);
    for (const PlacedCloud& placed : clouds) {
      insert_stock(tree, placed);
    }
    benchmark::DoNotOptimize(tree.size());
  }
  state.counters["sweeps_per_s"] =
      benchmark::Counter(kSweeps, benchmark::Counter::kIsIterationInvariantRate);
}

void Ours(benchmark::State& state) {
  const std::vector<PlacedCloud>& clouds = drive();
  for (auto _ : state) {
    OccupancyMap map({});
    for (const PlacedCloud& placed : clouds) {
      map.insert(placed.cloud, placed.T_map_base);
    }
    benchmark::DoNotOptimize(map.num_nodes());
  }
  state.counters["sweeps_per_s"] =
      benchmark::Counter(kSweeps, benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(Stock)->Unit(benchmark::kMillisecond);
BENCHMARK(Ours)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nodmap::slam6d
