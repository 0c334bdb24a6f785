// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/results.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "common/geometry/angle.hpp"
#include "sim/body/shortest_path.hpp"
#include "tools/evaluate/trajectory_error.hpp"
#include "tools/trial/metrics.hpp"
#include "tools/trial/path_image.hpp"

namespace nodmap::trial {
namespace {

using Json = nlohmann::ordered_json;

// Twice the time between two samples of the truth.
constexpr time::Duration kTolerance = 20ms;

Json number_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json numbers_or_null(const std::vector<std::optional<double>>& values) {
  Json list = Json::array();
  for (const std::optional<double>& value : values) {
    list.push_back(number_or_null(value));
  }
  return list;
}

Json write(const Quantiles& quantiles) {
  if (quantiles.n == 0) {
    return {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}, {"n", 0}};
  }
  return {
      {"p50", quantiles.p50}, {"p99", quantiles.p99}, {"max", quantiles.max}, {"n", quantiles.n}};
}

Json trajectory_errors(const formats::Trajectory& estimate, const TrialRecord& record,
                       bool planar) {
  const auto pairs = evaluate::associate(estimate, true_trajectory(record, planar), kTolerance);
  if (pairs.empty()) {
    return {{"n", 0}};
  }
  const auto errors = evaluate::measure_trajectory(pairs, evaluate::Alignment::kFirstPose);
  return {{"n", errors.n},
          {"ate_rmse_m", errors.ate_rmse_m},
          {"ate_max_m", errors.ate_max_m},
          {"rot_rmse_deg", geometry::rad_to_deg(errors.rot_rmse_rad)},
          {"end_error_m", errors.end_error_m},
          {"end_error_deg", geometry::rad_to_deg(errors.end_rot_rad)}};
}

std::optional<formats::Trajectory> read_if_there(const std::filesystem::path& file) {
  return std::filesystem::exists(file) ? std::optional(formats::read_tum(file)) : std::nullopt;
}

Json slam_errors(const std::filesystem::path& dir, const TrialRecord& record, bool planar) {
  const auto corrected = read_if_there(dir / "trajectory.tum");
  const auto online = read_if_there(dir / "online.tum");
  if (!corrected || !online) {
    return nullptr;
  }
  Json errors = trajectory_errors(*corrected, record, planar);
  errors["online"] = trajectory_errors(*online, record, planar);
  return errors;
}

Json brake_latency(const TrialOutcome& outcome) {
  std::vector<double> latencies_ms;
  std::size_t too_late = 0;
  Json events = Json::array();
  for (const BrakeEvent& event : outcome.brake_events) {
    if (event.answered) {
      const double limit_ms = 1e3 * time::seconds(event.limit());
      latencies_ms.push_back(1e-3 * time::FineDuration(*event.answered - event.started).count());
      too_late += latencies_ms.back() > limit_ms ? 1 : 0;
      events.push_back({{"latency_ms", latencies_ms.back()},
                        {"limit_ms", limit_ms},
                        {"speed_mps", event.speed_mps},
                        {"at_s", time::seconds(event.started.time_since_epoch())}});
    }
  }
  Json result = write(quantiles(latencies_ms));
  result["too_late"] = too_late;
  result["unanswered"] = outcome.brake_events.size() - latencies_ms.size();
  result["evaded"] = outcome.num_evaded;
  result["masked"] = outcome.num_masked;
  result["events"] = std::move(events);
  return result;
}

Json write(const Disturbance& disturbance, const StopMetrics& stop, double deceleration_mps2) {
  Json json = {{"what", disturbance.what},
               {"at_s", time::seconds(disturbance.started.time_since_epoch())},
               {"speed_mps", stop.speed_mps},
               {"stopped_after_s", number_or_null(stop.stopped_after_s)},
               {"reaction_s", nullptr},
               {"distance_m", stop.distance_m},
               {"braking_distance_m", stop.braking_distance_m},
               {"resumed_after_s", number_or_null(stop.resumed_after_s)}};
  if (stop.stopped_after_s) {
    json["reaction_s"] = *stop.stopped_after_s - std::abs(stop.speed_mps) / deceleration_mps2;
  }
  return json;
}

std::vector<Disturbance> disturbances(const TrialSetup& setup) {
  std::vector<Disturbance> all;
  for (const Kill& kill : setup.kills) {
    all.push_back({"kill " + kill.process, kill.begin, kill.begin + kill.duration});
  }
  for (const sim::Fault& fault : setup.faults) {
    all.push_back(
        {sim::name_of(fault.part) + " " + sim::name_of(fault.kind), fault.begin(), fault.end()});
  }
  return all;
}

Json stops(const TrialSetup& setup, const TrialRecord& record) {
  Json all = Json::array();
  // The deceleration of which the base is capable; the remaining time is reaction time.
  const double deceleration_mps2 = setup.params.kurt.limits.max_deceleration_mps2;
  for (const Disturbance& disturbance : disturbances(setup)) {
    all.push_back(write(disturbance, stop_metrics(record, disturbance, deceleration_mps2),
                        deceleration_mps2));
  }
  return all;
}

GoalTolerance goal_tolerance(const TrialSetup& setup) {
  const LoopParams& loop = setup.params.loop;
  return setup.world.goal_heading_rad
             ? GoalTolerance{loop.docking_tolerance_m, loop.docking_tolerance_rad}
             : GoalTolerance{loop.goal_tolerance_m};
}

Json heading_error_deg(const GoalMetrics& goal) {
  return goal.heading_error_rad ? Json(geometry::rad_to_deg(*goal.heading_error_rad)) : Json();
}

Json write(const GoalMetrics& goal, const std::optional<double>& shortest_m,
           const sim::Task& task) {
  return {{"reached", goal.reached.has_value()},
          {"time_s", number_or_null(goal.time_s)},
          {"after_motion_s", number_or_null(goal.after_motion_s)},
          {"path_m", goal.path_m},
          {"start_to_goal_m", goal.start_to_goal_m},
          {"remaining_m", goal.remaining_m},
          {"no_path_s", number_or_null(goal.no_path_s)},
          {"heading_error_deg", heading_error_deg(goal)},
          {"shortest_path_m", number_or_null(shortest_m)},
          {"reference_path_m", number_or_null(task.reference_path_m)},
          {"spl", number_or_null(goal.spl)}};
}

// How many goals the robot has reached, and whether it reports that no path leads to the next one.
Json write_goals(std::size_t num_goals, const TrialRecord& record) {
  const std::size_t num_reached = std::min(record.arrivals.size(), num_goals);
  const bool is_refused = num_reached < num_goals && record.refused;
  return {{"asked", num_goals}, {"reached", num_reached}, {"refused", is_refused ? 1 : 0}};
}

// Seconds from the first scan, and the fraction of the floor that MAP_2D shows then; null without
// the explorer.
Json seen_share(const TrialOutcome& outcome) {
  if (!outcome.exploration || !outcome.record.started) {
    return nullptr;
  }
  Json series = Json::array();
  for (const SeenSample& sample : outcome.exploration->seen) {
    series.push_back({time::seconds(sample.instant - *outcome.record.started), sample.ratio});
  }
  return series;
}

// Metrics of the exploration; null without the explorer.
Json exploration(const TrialOutcome& outcome) {
  if (!outcome.exploration) {
    return nullptr;
  }
  const ExplorationMetrics metrics = exploration_metrics(outcome.record, *outcome.exploration);
  return {{"seen_ratio", metrics.seen_ratio},
          {"to_90_m", number_or_null(metrics.to_90_m)},
          {"to_90_s", number_or_null(metrics.to_90_s)},
          {"home_s", number_or_null(metrics.home_s)},
          {"path_m", metrics.path_m},
          {"from_start_m", metrics.from_start_m}};
}

// Metrics of the occupancy map; null without a map.
Json occupancy(const TrialSetup& setup, const TrialOutcome& outcome,
               const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto map = formats::read_octomap(bytes);
  if (!map) {
    return nullptr;
  }
  const OccupancyMetrics metrics = occupancy_metrics(
      *map, outcome.observed_voxels, geometry::to_se3(setup.world.T_world_start), setup.world);
  return {{"precision", metrics.precision},
          {"recall", metrics.recall},
          {"num_occupied", metrics.num_occupied},
          {"num_observed", metrics.num_observed}};
}

}  // namespace

Json summarise(const TrialSetup& setup, const TrialOutcome& outcome,
               const std::filesystem::path& dir) {
  const TrialRecord& record = outcome.record;
  const DriveMetrics drive = drive_metrics(record);
  const auto shortest_m = sim::shortest_path_m(setup.world, setup.params.sim.model.body);
  const GoalMetrics goal = goal_metrics(record, setup.world, goal_tolerance(setup), shortest_m);
  const std::size_t num_goals = setup.world.goals.size();
  const time::SteadyTime started = record.started.value_or(time::SteadyTime{});
  Json result = {
      {"world", setup.world.name},
      {"seed", setup.seed},
      {"collisions", drive.contacts.collisions},
      {"first_collision_s", number_or_null(drive.first_collision_s)},
      {"noticed_s", numbers_or_null(drive.noticed_s)},
      {"slips", record.slips.size()},
      {"bumped", drive.contacts.bumps},
      {"distance_m", drive.distance_m},
      {"duration_s", drive.duration_s},
      {"first_scan_s", time::seconds(started.time_since_epoch())},
      {"mean_speed_mps", drive.mean_speed_mps},
      {"max_speed_mps", drive.max_speed_mps},
      {"min_clearance_m", number_or_null(drive.min_clearance_m)},
      {"first_motion_s", number_or_null(drive.first_motion_s)},
      {"contacts_caused", drive.contacts.contacts_caused},
      {"falls", drive.contacts.falls},
      {"goals", write_goals(num_goals, record)},
      {"goal_reached", goal.reached.has_value()},
      {"goal_time_s", number_or_null(goal.time_s)},
      {"goal", num_goals > 0 ? write(goal, shortest_m, setup.world.task) : Json(nullptr)},
      {"exploration", exploration(outcome)},
      {"seen_share", seen_share(outcome)},
      {"close_to_person_s", drive.close_to_person_s},
      {"brake_latency_ms", brake_latency(outcome)},
      {"sweep_s", write(quantiles(record.sweep_times_s))},
      {"slam2d", slam_errors(dir / "slam2d", record, true)},
      {"slam6d", slam_errors(dir / "slam6d", record, false)},
      {"slam2d_level", slam_errors(dir / "slam2d-level", record, true)},
      {"occupancy", occupancy(setup, outcome, dir / "slam6d" / "map.bt")},
      {"odometry", trajectory_errors(record.odometry, record, true)},
      {"stops", stops(setup, record)},
      {"processes", outcome.processes}};
  return result;
}

void write_path_image(const TrialSetup& setup, const TrialOutcome& outcome,
                      const std::filesystem::path& dir) {
  std::vector<EstimatedPath> estimates{{"odometry", outcome.record.odometry, {255, 140, 0}}};
  if (auto poses = read_if_there(dir / "slam2d" / "trajectory.tum")) {
    estimates.push_back({"2D SLAM", std::move(*poses), {0, 0, 0}});
  }
  if (auto poses = read_if_there(dir / "slam6d" / "trajectory.tum")) {
    estimates.push_back({"6D SLAM", std::move(*poses), {200, 0, 120}});
  }
  draw_paths(setup.world, outcome.record, estimates).write_png(dir / "path.png");
}

}  // namespace nodmap::trial
