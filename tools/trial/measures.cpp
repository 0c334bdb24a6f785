// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/trial/epoch.hpp"

namespace nodmap::trial {
namespace {

double seconds(std::int64_t duration_us) {
  return 1e-6 * static_cast<double>(duration_us);
}

double way_between(const TruthSample& a, const TruthSample& b) {
  return (b.T_world_base.translation() - a.T_world_base.translation()).head<2>().norm();
}

bool stands(const TruthSample& sample) {
  return std::abs(sample.forward_mps) < kStandingMps;
}

auto first_from(const TrialRecord& record, std::int64_t time_us) {
  return std::find_if(record.truth.begin(), record.truth.end(),
                      [time_us](const TruthSample& sample) { return sample.time_us >= time_us; });
}

}  // namespace

Quantiles quantiles(std::vector<double> values) {
  if (values.empty()) {
    return {};
  }
  std::sort(values.begin(), values.end());
  const auto rank = [&values](double share) {
    const auto n = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(n, 1) - 1];
  };
  return {rank(0.5), rank(0.99), values.back(), values.size()};
}

DriveMeasures measure_drive(const TrialRecord& record) {
  DriveMeasures measures;
  if (!record.began_us) {
    return measures;
  }
  const auto first = first_from(record, *record.began_us);
  if (first == record.truth.end()) {
    return measures;
  }
  measures.min_clearance_m = std::numeric_limits<double>::infinity();
  for (auto sample = first; sample != record.truth.end(); ++sample) {
    measures.max_speed_mps = std::max(measures.max_speed_mps, std::abs(sample->forward_mps));
    measures.min_clearance_m = std::min(measures.min_clearance_m, sample->clearance_m);
    measures.distance_m += sample == first ? 0.0 : way_between(*std::prev(sample), *sample);
    if (sample->collisions > 0 && !measures.first_collision_s) {
      measures.first_collision_s = seconds(sample->time_us - *record.began_us);
    }
  }
  const TruthSample& last = record.truth.back();
  measures.collisions = last.collisions;
  measures.bumped = last.bumps;
  measures.duration_s = seconds(last.time_us - first->time_us);
  measures.mean_speed_mps =
      measures.duration_s > 0.0 ? measures.distance_m / measures.duration_s : 0.0;
  return measures;
}

std::vector<double> sweep_times_s(const TrialRecord& record) {
  std::vector<double> times;
  for (std::size_t i = 1; i < record.turns_us.size(); ++i) {
    times.push_back(seconds(record.turns_us[i] - record.turns_us[i - 1]));
  }
  return times;
}

Stop measure_stop(const TrialRecord& record, const Disturbance& disturbance,
                  double deceleration_mps2) {
  Stop stop;
  const auto first = first_from(record, disturbance.began_us);
  const auto end = first_from(record, disturbance.ended_us);
  if (first == record.truth.end()) {
    return stop;
  }
  stop.speed_mps = first->forward_mps;
  stop.braking_way_m = stop.speed_mps * stop.speed_mps / (2.0 * deceleration_mps2);
  for (auto sample = first; sample != end; ++sample) {
    stop.way_m += sample == first ? 0.0 : way_between(*std::prev(sample), *sample);
    if (stands(*sample)) {
      stop.stood_after_s = seconds(sample->time_us - disturbance.began_us);
      break;
    }
  }
  const auto resumed = std::find_if(end, record.truth.end(), [](const TruthSample& sample) {
    // Turning on the spot is also driving.
    return !stands(sample) || std::abs(sample.yaw_rate_rad_s) > 0.05;
  });
  if (resumed != record.truth.end()) {
    stop.resumed_after_s = seconds(resumed->time_us - disturbance.ended_us);
  }
  return stop;
}

formats::Trajectory true_trajectory(const TrialRecord& record, bool planar) {
  formats::Trajectory trajectory;
  for (const TruthSample& sample : record.truth) {
    trajectory.push_back(
        {kEpochUs + sample.time_us,
         planar ? geometry::to_se3(geometry::to_se2(sample.T_world_base)) : sample.T_world_base});
  }
  return trajectory;
}

}  // namespace nodmap::trial
