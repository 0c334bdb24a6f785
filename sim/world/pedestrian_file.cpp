// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/pedestrian_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "common/formats/text_lines.hpp"
#include "common/formats/user_error.hpp"
#include "common/geometry/angle.hpp"
#include "sim/world/scenarios/builder.hpp"
#include "sim/world/world_file.hpp"

namespace nodmap::sim {
namespace {

constexpr double kWindowS = 120.0;
constexpr double kRadiusM = 0.25;
constexpr double kBorderM = 1.5;
constexpr double kHalfCrossingM = 5.0;

// The waypoints of each pedestrian, by number.
using Tracks = std::map<int, std::vector<Waypoint>>;

Tracks read_tracks(const std::filesystem::path& file, double frames_per_s) {
  formats::TextLines lines(file);
  Tracks tracks;
  while (lines.next()) {
    std::istringstream line{std::string(lines.line())};
    double frame = 0.0;
    int pedestrian = 0;
    Eigen::Vector2d p;
    if (!(line >> frame >> pedestrian >> p.x() >> p.y()) ||
        !(p.array().abs() <= kMaxWorldNumber).all()) {
      throw formats::UserError(lines.place() +
                               ": expected frame pedestrian x y, positions up to 1e5 m");
    }
    std::vector<Waypoint>& track = tracks[pedestrian];
    const double time_s = frame / frames_per_s;
    if (!track.empty() && time_s <= track.back().time_s) {
      throw formats::UserError(lines.place() + ": frames of a pedestrian must ascend");
    }
    track.push_back({time_s, p});
  }
  if (tracks.empty()) {
    throw formats::UserError(file.string() + ": contains no pedestrians");
  }
  return tracks;
}

Actor make_actor(const std::vector<Waypoint>& track, double begin_s) {
  Actor actor;
  actor.radius_m = kRadiusM;
  actor.path = track;
  for (Waypoint& waypoint : actor.path) {
    waypoint.time_s -= begin_s;
  }
  actor.appear_s = actor.path.front().time_s;
  actor.vanish_s = actor.path.back().time_s;
  return actor;
}

}  // namespace

World load_pedestrians(const std::filesystem::path& file, double frames_per_s, std::uint64_t seed) {
  const Tracks tracks = read_tracks(file, frames_per_s);
  Eigen::Vector2d min = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d max = -min;
  double first_s = 1e18;
  double last_s = -1e18;
  for (const auto& [pedestrian, track] : tracks) {
    for (const Waypoint& waypoint : track) {
      min = min.cwiseMin(waypoint.position);
      max = max.cwiseMax(waypoint.position);
    }
    first_s = std::min(first_s, track.front().time_s);
    last_s = std::max(last_s, track.back().time_s);
  }
  Builder builder(file.stem(), seed);
  const double begin_s = builder.between(first_s, std::max(first_s, last_s - kWindowS));
  for (const auto& [pedestrian, track] : tracks) {
    if (track.size() > 1 && track.back().time_s > begin_s &&
        track.front().time_s < begin_s + kWindowS) {
      builder.actor(make_actor(track, begin_s));
    }
  }
  builder.walls_around(min.array() - kBorderM, max.array() + kBorderM);
  const Eigen::Vector2d middle = 0.5 * (min + max);
  const double angle_rad = builder.between(-geometry::kPi, geometry::kPi);
  const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d start = middle - kHalfCrossingM * along;
  const Eigen::Vector2d goal = middle + kHalfCrossingM * along;
  builder.start(start.x(), start.y(), angle_rad);
  builder.goal(goal.x(), goal.y());
  return builder.finish();
}

}  // namespace nodmap::sim
