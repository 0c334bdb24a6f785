// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/pedestrian_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
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
constexpr double kWallMarginM = 1.5;
constexpr double kHalfCrossingM = 5.0;
constexpr double kMaxPedestrian = 1e9;

// The waypoints of each pedestrian, by number.
using Tracks = std::map<int, std::vector<Waypoint>>;

// Where a pedestrian was in a frame.
struct Sighting {
  double frame = 0.0;
  int pedestrian = 0;
  Eigen::Vector2d position;
};

// The numbers of pedestrians are whole, but often written as floats: "1.0". Empty if the line is
// anything else than four numbers.
std::optional<Sighting> read_sighting(std::string_view text) {
  std::istringstream line{std::string(text)};
  Sighting sighting;
  double pedestrian = 0.0;
  line >> sighting.frame >> pedestrian >> sighting.position.x() >> sighting.position.y();
  if (!line || !(line >> std::ws).eof() || pedestrian != std::round(pedestrian) ||
      !(std::abs(pedestrian) <= kMaxPedestrian) ||
      !(sighting.position.array().abs() <= kMaxWorldNumber).all()) {
    return std::nullopt;
  }
  sighting.pedestrian = static_cast<int>(pedestrian);
  return sighting;
}

Tracks read_tracks(const std::filesystem::path& file, double frames_per_s) {
  formats::TextLines lines(file);
  Tracks tracks;
  while (lines.next()) {
    const std::optional<Sighting> sighting = read_sighting(lines.line());
    if (!sighting) {
      throw formats::UserError(lines.place() +
                               ": expected frame pedestrian x y and nothing else, the pedestrian "
                               "a whole number, positions up to 1e5 m");
    }
    std::vector<Waypoint>& track = tracks[sighting->pedestrian];
    const double time_s = sighting->frame / frames_per_s;
    if (!track.empty() && time_s <= track.back().time_s) {
      throw formats::UserError(lines.place() + ": frames of a pedestrian must ascend");
    }
    track.push_back({time_s, sighting->position});
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
  builder.walls_around(min.array() - kWallMarginM, max.array() + kWallMarginM);
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
