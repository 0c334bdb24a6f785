// SPDX-License-Identifier: BSD-3-Clause
// Compares our insertion into an OctoMap with stock OctoMap's, in one run: the time to insert a
// sequence of clouds, the time to encode the files, and memory. Prints one JSON object. The exit
// code is 1 if the files are not the same.
//   nodmap-bench-octomap DIR
// DIR holds NNN.bin (uint64 count, then float32 x y z in the sensor's frame, m) and NNN_gt.txt (4x4
// T_world_sensor).
#include <octomap/octomap.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/occupancy/occupancy_map.hpp"
#include "tests/support/cloud_file.hpp"

namespace {

namespace fs = std::filesystem;
namespace geometry = nodmap::geometry;
using nodmap::slam6d::OccupancyMap;
using nodmap::slam6d::SweepCloud;
using nodmap::slam6d::TraceParams;

struct PlacedCloud {
  SweepCloud cloud;
  geometry::SE3 T_world_sensor = geometry::SE3::Identity();
};

SweepCloud read_cloud(const fs::path& file) {
  SweepCloud cloud;
  cloud.points = nodmap::test::read_cloud_file(file);
  cloud.lines.push_back({Eigen::Vector3f::Zero(), cloud.points.size()});
  return cloud;
}

std::vector<PlacedCloud> read_sequence(const fs::path& dir) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir)) {
    if (entry.path().extension() == ".bin") {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw std::runtime_error(dir.string() + ": holds no .bin file");
  }
  std::ranges::sort(files);
  std::vector<PlacedCloud> clouds;
  clouds.reserve(files.size());
  for (const fs::path& file : files) {
    clouds.push_back({read_cloud(file),
                      nodmap::test::read_matrix_file(dir / (file.stem().string() + "_gt.txt"))});
  }
  return clouds;
}

void insert_stock(octomap::OcTree& tree, const PlacedCloud& placed, const TraceParams& params) {
  const auto to_octomap = [](const Eigen::Vector3d& p) {
    return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()),
                            static_cast<float>(p.z()));
  };
  octomap::Pointcloud points;
  for (const Eigen::Vector3f& p : placed.cloud.points) {
    points.push_back(to_octomap(placed.T_world_sensor * p.cast<double>()));
  }
  tree.insertPointCloud(points, to_octomap(placed.T_world_sensor.translation()), params.max_range_m,
                        false, params.discretize);
}

template <typename Work>
double time_ms(const Work& work) {
  const double start_ms = nodmap::bench::process_cpu_ms();
  work();
  return nodmap::bench::process_cpu_ms() - start_ms;
}

OccupancyMap insert_ours(const std::vector<PlacedCloud>& clouds, const TraceParams& params) {
  OccupancyMap map(params);
  for (const PlacedCloud& placed : clouds) {
    map.insert(placed.cloud, placed.T_world_sensor);
  }
  return map;
}

// Runs our insertion both before and after the stock one, so that a change of the machine's speed
// affects both. They do not alternate cloud by cloud, because a large allocation of one would
// consolidate the many small blocks that the other has freed.
nlohmann::ordered_json compare(const std::vector<PlacedCloud>& clouds, const TraceParams& params) {
  OccupancyMap ours(params);
  double ours_ms = time_ms([&] { ours = insert_ours(clouds, params); });
  octomap::OcTree stock(params.resolution_m);
  const double stock_ms = time_ms([&] {
    for (const PlacedCloud& placed : clouds) {
      insert_stock(stock, placed, params);
    }
  });
  ours_ms = 0.5 * (ours_ms + time_ms([&] { ours = insert_ours(clouds, params); }));

  std::ostringstream bt;
  std::ostringstream ot;
  std::string ours_bt;
  std::string ours_ot;
  using Format = OccupancyMap::Format;
  const double stock_bt_ms = time_ms([&] { stock.writeBinaryConst(bt); });
  const double stock_ot_ms = time_ms([&] { stock.write(ot); });
  const double ours_bt_ms = time_ms([&] { ours_bt = ours.encode(Format::kBt).value(); });
  const double ours_ot_ms = time_ms([&] { ours_ot = ours.encode(Format::kOt).value(); });
  const auto scans = static_cast<double>(clouds.size());
  return {{"stock_ms_per_scan", stock_ms / scans},
          {"ours_ms_per_scan", ours_ms / scans},
          {"ratio", ours_ms / stock_ms},
          {"stock_mem_mb", 1e-6 * static_cast<double>(stock.memoryUsage())},
          {"ours_mem_mb", 1e-6 * static_cast<double>(ours.memory_bytes())},
          {"bt_identical", ours_bt == bt.str()},
          {"ot_identical", ours_ot == ot.str()},
          {"stock_encode_ms", {{"bt", stock_bt_ms}, {"ot", stock_ot_ms}}},
          {"ours_encode_ms", {{"bt", ours_bt_ms}, {"ot", ours_ot_ms}}}};
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Compares our insertion into an OctoMap with OctoMap's own.");
    std::string dir;
    TraceParams params;
    app.add_option("DIR", dir, "clouds NNN.bin with their true poses NNN_gt.txt")
        ->required()
        ->check(CLI::ExistingDirectory);
    app.add_option("--resolution", params.resolution_m, "edge of a voxel (m)")
        ->check(CLI::Range(0.01, 1.0))
        ->capture_default_str();
    app.add_option("--max-range", params.max_range_m, "beams are inserted up to this length (m)")
        ->check(CLI::Range(0.5, 100.0))
        ->capture_default_str();
    app.add_flag("--discretize", params.discretize, "one beam for each voxel that is hit");
    CLI11_PARSE(app, argc, argv);
    const auto result = compare(read_sequence(dir), params);
    std::cout << result.dump(2) << "\n";
    return result["bt_identical"].get<bool>() && result["ot_identical"].get<bool>() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodmap-bench-octomap: %s\n", error.what());
    return 1;
  }
}
