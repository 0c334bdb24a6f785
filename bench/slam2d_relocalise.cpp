// SPDX-License-Identifier: BSD-3-Clause
// Measures relocalisation in simulated buildings. In each, scans from places 0.6 m apart, two in
// opposite random directions, make a map; scans from 200 random poses are then located in it, alone
// and in groups of three. Prints a table for docs/benchmark-2d.md. Call (WORLD as for
// nodmap-trial):
//   nodmap-bench-slam2d-relocalise WORLD ...
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/timing.hpp"
#include "common/geometry/angle.hpp"
#include "modules/slam2d/grid/keyframe_grid.hpp"
#include "modules/slam2d/localise/known_map.hpp"
#include "sim/body/collision.hpp"
#include "sim/body/rangefinder.hpp"
#include "sim/world/world_name.hpp"
#include "tools/evaluate/group_relocaliser.hpp"

namespace {

using namespace nodmap;
using geometry::SE2;
using slam2d::OrientedPoint;

constexpr int kPoses = 200;
constexpr double kPlaceDistanceM = 0.3;
constexpr int kMapEvery = 2;            // places, in x and in y
constexpr double kMinClearanceM = 0.1;  // of the robot's body
constexpr double kLaserHeightM = 0.4;
constexpr double kStepM = 0.15;  // between the scans of a group
constexpr double kStepRad = 0.1;
constexpr double kRightM = 0.25;
constexpr double kRightRad = geometry::deg_to_rad(3.0);

// A robot with a level laser that is set down anywhere in a world.
class Robot {
 public:
  explicit Robot(const sim::World& world)
      : caster_(world), collision_(world, {}), rangefinder_({}, 1) {}

  [[nodiscard]] bool fits(const SE2& pose) const {
    return collision_.clearance_m({.T_world_base = pose}) >= kMinClearanceM;
  }

  // The points of a scan of 181 beams over 180 degrees.
  [[nodiscard]] std::vector<OrientedPoint> scan(const SE2& pose) {
    scan::Scan scan;
    scan.angle_first_rad = -0.5 * geometry::kPi;
    scan.angle_step_rad = geometry::deg_to_rad(1.0);
    scan.range_min_m = 0.05;
    scan.range_max_m = sim::LaserParams().max_range_m;
    const geometry::SE3 T_world_laser =
        geometry::to_se3(pose) * Eigen::Translation3d(0.0, 0.0, kLaserHeightM);
    for (std::size_t beam = 0; beam < 181; ++beam) {
      const sim::Echo echo = rangefinder_.measure(caster_, T_world_laser, scan.angle_rad(beam), {});
      scan.ranges_m.push_back(echo.kind == sim::Echo::Kind::kRange
                                  ? static_cast<float>(echo.range_m)
                                  : std::numeric_limits<float>::infinity());
    }
    const auto points = extractor_.extract(scan, {});
    return {points.begin(), points.end()};
  }

 private:
  sim::RayCaster caster_;
  sim::Collision collision_;
  sim::Rangefinder rangefinder_;
  slam2d::OrientedPointExtractor extractor_;
};

using Place = std::pair<int, int>;  // in steps of kPlaceDistanceM from the start

SE2 pose_at(const sim::World& world, const Place& place, double yaw_rad) {
  return {world.T_world_start.x + kPlaceDistanceM * place.first,
          world.T_world_start.y + kPlaceDistanceM * place.second, yaw_rad};
}

// The places that the robot can reach from the start, in their order.
std::set<Place> reachable_places(const sim::World& world, const Robot& robot) {
  std::set<Place> reached{{0, 0}};
  std::vector<Place> open{{0, 0}};
  while (!open.empty()) {
    const Place at = open.back();
    open.pop_back();
    for (const auto& [dx, dy] : {Place{1, 0}, Place{-1, 0}, Place{0, 1}, Place{0, -1}}) {
      const Place next{at.first + dx, at.second + dy};
      const bool fits = robot.fits(pose_at(world, next, 0.0)) &&
                        robot.fits(pose_at(world, next, 0.5 * geometry::kPi));
      if (fits && reached.insert(next).second) {
        open.push_back(next);
      }
    }
  }
  return reached;
}

void draw_scan(Robot& robot, const SE2& pose, slam2d::OccupancyGrid& grid) {
  slam2d::Keyframe keyframe;
  set_points(keyframe, robot.scan(pose));
  draw(keyframe, pose, grid);
}

// Drawn from scans in opposite directions, as of a robot that comes by both ways.
slam2d::KnownMap make_map(const sim::World& world, const std::set<Place>& places, Robot& robot,
                          std::mt19937& random) {
  std::uniform_real_distribution<double> heading(-geometry::kPi, geometry::kPi);
  slam2d::OccupancyGrid grid(0.05);
  for (const Place& place : places) {
    if (place.first % kMapEvery != 0 || place.second % kMapEvery != 0) {
      continue;
    }
    const SE2 pose = pose_at(world, place, heading(random));
    draw_scan(robot, pose, grid);
    draw_scan(robot, pose * SE2{0.0, 0.0, geometry::kPi}, grid);
  }
  return {trinary(grid), {}};
}

struct Result {
  int right = 0;
  int wrong = 0;
  int said_lost = 0;
  std::vector<double> ms = {};
};

// Locates the last of `num_scans` scans, taken while the robot drives a little; odometry is right.
void locate(const slam2d::KnownMap& map, Robot& robot, const SE2& first, std::size_t num_scans,
            Result& result) {
  const slam2d::Slam2dParams params;
  const evaluate::GroupRelocaliser relocaliser(params.relocalise, params.matcher);
  std::vector<std::vector<OrientedPoint>> points;
  std::vector<slam2d::LevelScan> scans;
  SE2 pose = first;
  for (std::size_t i = 0; i < num_scans; ++i) {
    const SE2 next = pose * SE2{kStepM, 0.0, kStepRad};
    pose = i == 0 || !robot.fits(next) ? pose : next;
    points.push_back(robot.scan(pose));
    slam2d::LevelScan scan;
    scan.T_odom_base = first.inverse() * pose;
    scans.push_back(scan);
  }
  for (std::size_t i = 0; i < num_scans; ++i) {
    scans[i].points_base = points[i];
  }
  const double begin_ms = bench::process_cpu_ms();
  const slam2d::Relocalisation found = relocaliser.locate(map, scans);
  result.ms.push_back(bench::process_cpu_ms() - begin_ms);
  if (found.status != slam2d::Relocalisation::Status::kFound) {
    ++result.said_lost;
    return;
  }
  const bool is_right = geometry::distance_m(found.T_map_base, pose) <= kRightM &&
                        geometry::rotation_rad(found.T_map_base, pose) <= kRightRad;
  ++(is_right ? result.right : result.wrong);
  if (!is_right) {
    std::fprintf(stderr, "wrong: at %.2f %.2f %.2f, found %.2f %.2f %.2f, score %.3f, next %.3f\n",
                 pose.x, pose.y, pose.yaw, found.T_map_base.x, found.T_map_base.y,
                 found.T_map_base.yaw, found.score, found.runner_up_score);
  }
}

void measure(const std::string& name) {
  const sim::World world = sim::make_world(name);
  Robot robot(world);
  std::mt19937 random(1);
  const std::set<Place> places = reachable_places(world, robot);
  const slam2d::KnownMap map = make_map(world, places, robot, random);
  const std::vector<Place> list(places.begin(), places.end());
  std::uniform_int_distribution<std::size_t> index(0, list.size() - 1);
  std::uniform_real_distribution<double> offset_m(-0.5 * kPlaceDistanceM, 0.5 * kPlaceDistanceM);
  std::uniform_real_distribution<double> heading(-geometry::kPi, geometry::kPi);
  Result one;
  Result three;
  while (one.ms.size() < kPoses) {
    SE2 pose = pose_at(world, list[index(random)], heading(random));
    pose.x += offset_m(random);
    pose.y += offset_m(random);
    if (robot.fits(pose)) {
      locate(map, robot, pose, 1, one);
      locate(map, robot, pose, 3, three);
    }
  }
  std::sort(one.ms.begin(), one.ms.end());
  const double floor_m2 = kPlaceDistanceM * kPlaceDistanceM * static_cast<double>(places.size());
  std::printf("| %s | %.0f m² | %d / %d / %d | %d / %d / %d | %.0f, %.0f |\n", world.name.c_str(),
              floor_m2, one.right, one.wrong, one.said_lost, three.right, three.wrong,
              three.said_lost, one.ms[one.ms.size() / 2], one.ms.back());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Places single scans and groups of three from nothing in the maps of worlds.");
    std::vector<std::string> worlds;
    app.add_option("WORLD", worlds, "a world file, or SCENARIO:SEED")->required();
    CLI11_PARSE(app, argc, argv);
    std::printf(
        "| world | floor | one scan: right / wrong / said lost | three scans | ms, median and most "
        "|\n");
    std::printf("|---|---|---|---|---|\n");
    for (const std::string& world : worlds) {
      measure(world);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodmap-bench-slam2d-relocalise: %s\n", error.what());
    return 1;
  }
  return 0;
}
