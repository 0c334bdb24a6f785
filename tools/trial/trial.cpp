// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/trial.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "nodmap/goal_t.hpp"
#include "tools/trial/ground_truth_monitor.hpp"
#include "tools/trial/level_laser.hpp"
#include "tools/trial/robot_software.hpp"

namespace nodmap::trial {
namespace {

/// Laser and servo are searched at several baud rates, and the laser takes a while to boot.
constexpr std::int64_t kMaxStartUs = 60'000'000;
/// The level laser has the same noise as the nodding one, but not the same numbers.
constexpr std::uint64_t kLevelLaserSeed = 1'000'000;
constexpr std::int64_t kGoalPeriodUs = 1'000'000;
constexpr std::int64_t kAfterArrivalUs = 1'000'000;

std::int64_t microseconds(double duration_s) {
  return std::llround(1e6 * duration_s);
}

/// Publishes the world's goals one after the other, and repeats the present one for processes that
/// are started later.
class GoalPublisher {
 public:
  GoalPublisher(const sim::World& world, const LoopParams& params, bus::LoopNetwork& network)
      : world_(world), bus_(network) {
    message_.is_active = 1;
    message_.tolerance_m = params.goal_tolerance_m;
  }

  /// `num_reached`: the goals that the robot has arrived at.
  void publish(std::int64_t now_us, std::size_t num_reached) {
    const bool is_next = num_reached > num_reached_;
    num_reached_ = num_reached;
    if (num_reached_ >= world_.goals.size() || (!is_next && now_us % kGoalPeriodUs != 0)) {
      return;
    }
    // The map begins where the robot starts.
    const Eigen::Vector2d p_map = world_.T_world_start.inverse() * world_.goals[num_reached_];
    message_.position_m[0] = p_map.x();
    message_.position_m[1] = p_map.y();
    message_.utime = kEpochUs + now_us;
    bus_.publish("GOAL", message_);
    ++message_.goal_seq;
  }

 private:
  const sim::World& world_;
  bus::LoopBus bus_;
  nodmap::goal_t message_{};
  std::size_t num_reached_ = 0;
};

}  // namespace

struct Trial::Parts {
  Parts(const TrialSetup& setup, const std::filesystem::path& log)
      : hardware(setup.world, setup.params.sim, setup.faults, setup.seed),
        network(log, {.min_us = microseconds(setup.params.loop.message_delay_s),
                      .mean_jitter_us = microseconds(setup.params.loop.message_jitter_s),
                      .seed = setup.seed}),
        monitor(setup.world, hardware.model(), network, stopping_zone(setup)),
        goal(setup.world, setup.params.loop, network),
        robot(hardware, network, setup.params, setup.robot, setup.without) {
    if (setup.level_laser) {
      level_laser.emplace(setup.world, setup.params, setup.seed + kLevelLaserSeed,
                          monitor.T_world_base(), network,
                          std::filesystem::path(log).replace_filename("level-laser.lcmlog"));
    }
  }

  sim::SimulatedRobot hardware;
  bus::LoopNetwork network;
  GroundTruthMonitor monitor;
  GoalPublisher goal;
  RobotSoftware robot;
  std::optional<LevelLaserSlam> level_laser;
};

Trial::Trial(const TrialSetup& setup, const std::filesystem::path& dir)
    : setup_(setup), dir_(dir), parts_(std::make_unique<Parts>(setup_, dir / "trial.lcmlog")) {}

Trial::~Trial() = default;

bool Trial::step() {
  parts_->hardware.advance_to(now_us_);
  parts_->network.set_time(kEpochUs + now_us_);
  apply_kills();
  parts_->robot.step();
  parts_->monitor.update();
  parts_->goal.publish(now_us_, record().arrivals_us.size());
  parts_->network.deliver();
  now_us_ += kStepUs;
  return !is_over();
}

const TrialRecord& Trial::record() const {
  return parts_->monitor.record();
}

bool Trial::is_over() const {
  if (!record().started_us) {
    if (now_us_ >= kMaxStartUs) {
      throw std::runtime_error("the scanner gave no scan within a minute");
    }
    return false;
  }
  return now_us_ > *record().started_us + setup_.duration_us || has_arrived() || has_failed();
}

bool Trial::has_arrived() const {
  const std::size_t num_goals = setup_.world.goals.size();
  if (setup_.world.task.arrival_radius_m) {
    return record().reached_us.has_value();
  }
  return num_goals > 0 && record().arrivals_us.size() >= num_goals &&
         now_us_ > record().arrivals_us[num_goals - 1] + kAfterArrivalUs;
}

/// By the rules of the world's task.
bool Trial::has_failed() const {
  const sim::Task& task = setup_.world.task;
  const TruthSample& last = record().truth.back();
  const bool is_late = task.time_limit_s && record().moved_us &&
                       now_us_ > *record().moved_us + microseconds(*task.time_limit_s);
  return is_late || (task.ends_at_contact && last.collisions + last.bumps > 0);
}

void Trial::apply_kills() {
  for (const Kill& kill : setup_.kills) {
    if (now_us_ == kill.at_us) {
      parts_->robot.kill(kill.process);
    } else if (now_us_ == kill.at_us + kill.duration_us) {
      parts_->robot.start(kill.process);
    }
  }
}

TrialOutcome Trial::finish() {
  parts_->robot.finish();
  parts_->robot.write_results(dir_);
  if (parts_->level_laser) {
    parts_->level_laser->finish(dir_ / "slam2d-level");
  }
  if (!parts_->network.flush()) {
    throw std::runtime_error((dir_ / "trial.lcmlog").string() + ": the disk takes no more");
  }
  return {record(), parts_->monitor.observed_voxels(), parts_->monitor.brake_latency().events(),
          parts_->monitor.brake_latency().num_evaded(), parts_->robot.report()};
}

StoppingZone stopping_zone(const TrialSetup& setup) {
  return {.body_length_m = setup.params.sim.model.body.length_m,
          .body_width_m = setup.params.sim.model.body.width_m,
          .deceleration_mps2 = setup.params.loop.deceleration_mps2};
}

}  // namespace nodmap::trial
