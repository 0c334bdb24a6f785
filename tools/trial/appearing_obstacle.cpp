// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/appearing_obstacle.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tools/trial/metrics.hpp"

namespace nodmap::trial {
namespace {

constexpr double kMinSpeedMps = 0.5;
// A radius of more than 3 m at that speed counts as straight.
constexpr double kStraightRadS = 0.15;
// Distance inside the far end of the stopping zone, so that the obstacle counts from its first
// moment.
constexpr double kInsideM = 0.01;
// For which the undisturbed run goes on; two of the longest sweeps take 2 s.
constexpr time::Duration kFollowed = 3s;

struct Shape {
  double radius_m;
  double height_m;
};
constexpr std::array kShapes{Shape{0.15, 0.10}, Shape{0.015, 0.45}, Shape{0.25, 1.75}};

bool is_driving_straight(const TruthSample& sample) {
  return sample.forward_mps >= kMinSpeedMps && std::abs(sample.yaw_rate_rad_s) <= kStraightRadS;
}

// The state at which the obstacle will appear.
TruthSample find_appearance(Trial& trial, double from_s) {
  while (trial.step()) {
    const TruthSample& sample = trial.record().truth.back();
    if (trial.record().started && time::seconds(sample.instant.time_since_epoch()) >= from_s &&
        is_driving_straight(sample)) {
      return sample;
    }
  }
  throw std::runtime_error("--appear: from then on the robot never drives straight at 0.5 m/s");
}

sim::Actor make_actor(const TrialSetup& setup, const TruthSample& sample, double zone_m) {
  const Shape& shape = kShapes.at(setup.seed % kShapes.size());
  const double ahead_m =
      0.5 * setup.params.sim.model.body.length_m + zone_m - kInsideM + shape.radius_m;
  const Eigen::Vector2d place =
      geometry::to_se2(sample.T_world_base) * Eigen::Vector2d(ahead_m, 0.0);
  sim::Actor actor;
  actor.radius_m = shape.radius_m;
  actor.height_m = shape.height_m;
  actor.path = {{0.0, place}};
  actor.appear_s = time::seconds(sample.instant.time_since_epoch());
  return actor;
}

}  // namespace

void add_appearing_obstacle(TrialSetup& setup, double from_s, const std::filesystem::path& dir) {
  TruthSample sample;
  double sweep_s = 0.0;
  UndisturbedRun undisturbed{.actor = setup.world.actors.size(), .drives_mps = {}};
  {
    Trial trial(setup, dir);
    sample = find_appearance(trial, from_s);
    if (!trial.record().sweep_times_s.empty()) {
      sweep_s = trial.record().sweep_times_s.back();
    }
    const time::SteadyTime end = trial.now() + kFollowed;
    while (trial.now() < end && trial.step()) {
    }
    undisturbed.drives_mps = trial.record().drives_mps;
  }
  // Written by the same setup in full: another listener would change the delays of the messages.
  remove_logs(dir);
  setup.world.actors.push_back(
      make_actor(setup, sample, stopping_zone(setup).length_m(sample.forward_mps, sweep_s)));
  setup.undisturbed = std::move(undisturbed);
}

}  // namespace nodmap::trial
