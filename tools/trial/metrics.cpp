// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/statistics/quantile.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {
namespace {

using time::seconds;

double distance_between(const TruthSample& a, const TruthSample& b) {
  return (b.T_world_base.translation() - a.T_world_base.translation()).head<2>().norm();
}

bool is_stationary(const TruthSample& sample) {
  return std::abs(sample.forward_mps) < kStationaryMps &&
         std::abs(sample.yaw_rate_rad_s) < kStationaryRadS;
}

// A rotation on the spot also counts as motion.
bool is_moving(const TruthSample& sample) {
  constexpr double kMinMps = 0.05;
  return std::abs(sample.forward_mps) >= kMinMps ||
         std::abs(sample.yaw_rate_rad_s) > kStationaryRadS;
}

auto first_from(const TrialRecord& record, time::SteadyTime instant) {
  return std::ranges::find_if(
      record.truth, [instant](const TruthSample& sample) { return sample.instant >= instant; });
}

std::vector<std::optional<double>> noticed_s(const TrialRecord& record) {
  std::vector<time::SteadyTime> collisions;
  std::int64_t counted = 0;
  for (const TruthSample& sample : record.truth) {
    if (std::exchange(counted, sample.contacts.collisions) < sample.contacts.collisions) {
      collisions.push_back(sample.instant);
    }
  }
  std::vector<std::optional<double>> delays_s;
  for (std::size_t i = 0; i < collisions.size(); ++i) {
    const auto slip = std::ranges::lower_bound(record.slips, collisions[i]);
    const bool is_noticed =
        slip != record.slips.end() && (i + 1 == collisions.size() || *slip <= collisions[i + 1]);
    delays_s.push_back(is_noticed ? std::optional(seconds(*slip - collisions[i])) : std::nullopt);
  }
  return delays_s;
}

}  // namespace

Quantiles quantiles(const std::vector<double>& values) {
  return {statistics::quantile(values, 0.5), statistics::quantile(values, 0.99),
          statistics::quantile(values, 1.0), values.size()};
}

DriveMetrics drive_metrics(const TrialRecord& record) {
  DriveMetrics metrics;
  if (!record.started) {
    return metrics;
  }
  const auto first = first_from(record, *record.started);
  if (first == record.truth.end()) {
    return metrics;
  }
  metrics.min_clearance_m = std::numeric_limits<double>::infinity();
  for (auto sample = first; sample != record.truth.end(); ++sample) {
    metrics.max_speed_mps = std::max(metrics.max_speed_mps, std::abs(sample->forward_mps));
    metrics.min_clearance_m = std::min(metrics.min_clearance_m, sample->clearance_m);
    metrics.distance_m += sample == first ? 0.0 : distance_between(*std::prev(sample), *sample);
    metrics.close_to_person_s += sample != first && sample->person_clearance_m < kPersonalSpaceM
                                     ? seconds(sample->instant - std::prev(sample)->instant)
                                     : 0.0;
    if (!metrics.first_motion_s && is_moving(*sample)) {
      metrics.first_motion_s = seconds(sample->instant - *record.started);
    }
    if (sample->contacts.collisions > 0 && !metrics.first_collision_s) {
      metrics.first_collision_s = seconds(sample->instant - *record.started);
    }
  }
  const TruthSample& last = record.truth.back();
  metrics.contacts = last.contacts;
  metrics.noticed_s = noticed_s(record);
  metrics.duration_s = seconds(last.instant - first->instant);
  metrics.mean_speed_mps = metrics.duration_s > 0.0 ? metrics.distance_m / metrics.duration_s : 0.0;
  return metrics;
}

namespace {

// The robot reports its arrival by the pose of 2D SLAM. Where it then truly is may be farther from
// the goal by this error of the pose. R37 permits the heading of 2D SLAM to err by half a degree.
constexpr double kPoseErrorM = 0.02;
constexpr double kPoseErrorRad = geometry::deg_to_rad(0.5);

double distance_at_end(const TrialRecord& record, const sim::World& world) {
  const Eigen::Vector2d end = record.truth.back().T_world_base.translation().head<2>();
  return (end - world.goals.back()).norm();
}

// Empty if the goal has no heading.
std::optional<double> heading_error_at_end(const TrialRecord& record, const sim::World& world) {
  if (!world.goal_heading_rad) {
    return std::nullopt;
  }
  const double yaw_rad = geometry::to_se2(record.truth.back().T_world_base).yaw;
  return geometry::angle_difference(yaw_rad, *world.goal_heading_rad);
}

std::optional<time::SteadyTime> reached(const TrialRecord& record, const sim::World& world,
                                        const GoalTolerance& tolerance) {
  if (world.task.arrival_radius_m) {
    return record.reached;
  }
  const std::size_t num_goals = world.goals.size();
  if (num_goals == 0 || record.arrivals.size() < num_goals) {
    return std::nullopt;
  }
  const double heading_error_rad = heading_error_at_end(record, world).value_or(0.0);
  const bool is_there = distance_at_end(record, world) <= tolerance.distance_m + kPoseErrorM &&
                        std::abs(heading_error_rad) <= tolerance.heading_rad + kPoseErrorRad;
  return is_there ? std::optional(record.arrivals[num_goals - 1]) : std::nullopt;
}

// Path length from the first scan until `end`; without it, to the end of the record.
double path_until(const TrialRecord& record, std::optional<time::SteadyTime> end) {
  double path_m = 0.0;
  const auto first = first_from(record, *record.started);
  for (auto sample = first; sample != record.truth.end(); ++sample) {
    if (end && sample->instant > *end) {
      break;
    }
    path_m += sample == first ? 0.0 : distance_between(*std::prev(sample), *sample);
  }
  return path_m;
}

}  // namespace

ExplorationMetrics exploration_metrics(const TrialRecord& record,
                                       const ExplorationRecord& exploration) {
  constexpr double kMost = 0.9;
  ExplorationMetrics metrics;
  if (!record.started || record.truth.empty() || exploration.seen.empty()) {
    return metrics;
  }
  metrics.seen_ratio = exploration.seen.back().ratio;
  const auto most = std::ranges::find_if(
      exploration.seen, [](const SeenSample& sample) { return sample.ratio >= kMost; });
  const auto first = first_from(record, *record.started);
  for (auto sample = first; sample != record.truth.end(); ++sample) {
    metrics.path_m += sample == first ? 0.0 : distance_between(*std::prev(sample), *sample);
    if (most != exploration.seen.end() && sample->instant <= most->instant) {
      metrics.to_90_m = metrics.path_m;
      metrics.to_90_s = seconds(most->instant - *record.started);
    }
  }
  if (exploration.home) {
    metrics.home_s = seconds(*exploration.home - *record.started);
  }
  metrics.from_start_m = distance_between(*first, record.truth.back());
  return metrics;
}

GoalMetrics goal_metrics(const TrialRecord& record, const sim::World& world,
                         const GoalTolerance& tolerance, std::optional<double> shortest_path_m) {
  GoalMetrics metrics;
  if (!record.started || record.truth.empty()) {
    return metrics;
  }
  metrics.reached = reached(record, world, tolerance);
  metrics.path_m = path_until(record, metrics.reached);
  if (!world.goals.empty()) {
    metrics.start_to_goal_m = (world.T_world_start.translation() - world.goals.back()).norm();
    metrics.remaining_m = distance_at_end(record, world);
    metrics.heading_error_rad = heading_error_at_end(record, world);
  }
  if (record.refused) {
    metrics.no_path_s = seconds(*record.refused - *record.started);
  }
  if (metrics.reached) {
    metrics.time_s = seconds(*metrics.reached - *record.started);
    metrics.after_motion_s = seconds(*metrics.reached - record.moved.value_or(time::SteadyTime{}));
  }
  if (shortest_path_m) {
    const double radius_m = world.task.arrival_radius_m.value_or(tolerance.distance_m);
    const double shortest_m = std::max(0.0, *shortest_path_m - radius_m);
    metrics.spl = metrics.reached && shortest_m > 0.0
                      ? shortest_m / std::max(metrics.path_m, shortest_m)
                      : 0.0;
  }
  return metrics;
}

StopMetrics stop_metrics(const TrialRecord& record, const Disturbance& disturbance,
                         double deceleration_mps2) {
  StopMetrics stop;
  const auto first = first_from(record, disturbance.started);
  const auto end = first_from(record, disturbance.ended);
  if (first == record.truth.end()) {
    return stop;
  }
  stop.speed_mps = first->forward_mps;
  stop.braking_distance_m = stop.speed_mps * stop.speed_mps / (2.0 * deceleration_mps2);
  for (auto sample = first; sample != end; ++sample) {
    stop.distance_m += sample == first ? 0.0 : distance_between(*std::prev(sample), *sample);
    if (is_stationary(*sample)) {
      stop.stopped_after_s = seconds(sample->instant - disturbance.started);
      break;
    }
  }
  const bool was_stationary = is_stationary(*first);
  const double resumed_mps = 0.5 * std::abs(stop.speed_mps);
  const auto resumed = std::find_if(end, record.truth.end(), [&](const TruthSample& sample) {
    return was_stationary ? is_moving(sample) : std::abs(sample.forward_mps) >= resumed_mps;
  });
  if (resumed != record.truth.end()) {
    stop.resumed_after_s = seconds(resumed->instant - disturbance.ended);
  }
  return stop;
}

formats::Trajectory true_trajectory(const TrialRecord& record, bool planar) {
  formats::Trajectory trajectory;
  for (const TruthSample& sample : record.truth) {
    trajectory.push_back(
        {stamp_at(sample.instant),
         planar ? geometry::to_se3(geometry::to_se2(sample.T_world_base)) : sample.T_world_base});
  }
  return trajectory;
}

}  // namespace nodmap::trial
