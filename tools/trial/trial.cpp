// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/trial.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "common/node/program.hpp"
#include "nodmap/goal_t.hpp"
#include "tools/trial/ground_truth_monitor.hpp"
#include "tools/trial/level_laser_slam.hpp"
#include "tools/trial/robot_software.hpp"

namespace nodmap::trial {
namespace {

// Latest time of the first scan: the drivers try several baud rates, and the laser takes a while
// to boot.
constexpr const char* kLog = "trial.lcmlog";
constexpr const char* kLevelLaserLog = "level-laser.lcmlog";
constexpr time::SteadyTime kLatestStart(60s);
// The level laser's noise has the same distribution as the nodding one's, but other random
// numbers.
constexpr std::uint64_t kLevelLaserSeed = 1'000'000;
constexpr time::Duration kGoalPeriod = 1s;
constexpr time::Duration kTimeAfterArrival = 1s;

// Publishes the world's goals one after the other, and repeats the present one for processes that
// are started later.
class GoalPublisher {
 public:
  GoalPublisher(const sim::World& world, const LoopParams& params, bus::LoopNetwork& network)
      : world_(world), params_(params), bus_(network) {
    message_.is_active = 1;
    message_.tolerance_m = params.goal_tolerance_m;
  }

  // `num_reached`: the goals that the robot has arrived at.
  void publish(time::SteadyTime now, std::size_t num_reached) {
    const bool is_new = message_.utime == 0 || num_reached > num_reached_;
    num_reached_ = num_reached;
    if (num_reached_ >= world_.goals.size() ||
        (!is_new && now.time_since_epoch() % kGoalPeriod != 0s)) {
      return;
    }
    if (is_new) {
      decide(now);
    }
    bus_.publish("GOAL", message_);
    ++message_.goal_seq;
  }

 private:
  void decide(time::SteadyTime now) {
    message_.utime = time::to_utime(stamp_at(now));
    // The map's origin is the robot's start.
    const Eigen::Vector2d p_map = world_.T_world_start.inverse() * world_.goals[num_reached_];
    message_.position_m[0] = p_map.x();
    message_.position_m[1] = p_map.y();
    if (world_.goal_heading_rad && num_reached_ + 1 == world_.goals.size()) {
      message_.has_heading = 1;
      message_.heading_rad = *world_.goal_heading_rad - world_.T_world_start.yaw;
      message_.tolerance_m = params_.docking_tolerance_m;
      message_.heading_tolerance_rad = params_.docking_tolerance_rad;
    }
  }

  const sim::World& world_;
  const LoopParams& params_;
  bus::LoopBus bus_;
  nodmap::goal_t message_{};
  std::size_t num_reached_ = 0;
};

// The setup with its world as the parameters want it.
TrialSetup with_world_params(TrialSetup setup) {
  const WorldParams& params = setup.params.world;
  if (params.floor_reflectivity > 0.0) {
    setup.world.floor_reflectivity = params.floor_reflectivity;
  }
  for (sim::Actor& actor : setup.world.actors) {
    if (params.people_reflectivity > 0.0) {
      actor.reflectivity = params.people_reflectivity;
    }
    actor.has_legs = actor.has_legs || params.legs;
  }
  return setup;
}

// The explorer begins at once.
AllParams params_of(const TrialSetup& setup) {
  AllParams params = setup.params;
  params.explorer.start = true;
  return params;
}

Eigen::Vector3d mirror(const TrialSetup& setup) {
  const sim::ServoParams& servo = setup.params.sim.model.servo;
  return {servo.mount_x_m + servo.mirror_forward_m, 0.0, servo.mount_z_m + servo.mirror_up_m};
}

}  // namespace

struct Trial::Parts {
  Parts(const TrialSetup& setup, const std::filesystem::path& log)
      : hardware(setup.world, setup.params.sim, setup.faults, setup.seed),
        network(log, {.min = time::from_seconds(setup.params.loop.message_delay_s),
                      .mean_jitter = time::from_seconds(setup.params.loop.message_jitter_s),
                      .seed = setup.seed}),
        monitor(setup.world, hardware.model(), network,
                BrakeLatencyMonitor(stopping_zone(setup), setup.undisturbed), mirror(setup),
                setup.params.slam6d.occupancy.trace),
        goal(setup.world, setup.params.loop, network),
        robot(hardware, network, params_of(setup), setup.robot, omitted_processes(setup),
              setup.map) {
    if (setup.level_laser) {
      level_laser.emplace(setup.world, setup.params, setup.seed + kLevelLaserSeed,
                          monitor.T_world_base(), network,
                          std::filesystem::path(log).replace_filename(kLevelLaserLog));
    }
    if (setup.explores) {
      exploration.emplace(setup.world, hardware.model(), setup.params.sim.model.body, network);
    }
  }

  sim::SimulatedRobot hardware;
  bus::LoopNetwork network;
  GroundTruthMonitor monitor;
  GoalPublisher goal;
  RobotSoftware robot;
  std::optional<LevelLaserSlam> level_laser;
  std::optional<ExplorationMonitor> exploration;
};

Trial::Trial(const TrialSetup& setup, const std::filesystem::path& dir)
    : setup_(with_world_params(setup)),
      dir_(dir),
      parts_(std::make_unique<Parts>(setup_, dir / kLog)) {}

Trial::~Trial() = default;

bool Trial::step() {
  if (node::stop_requested()) {
    throw std::runtime_error("stopped; the results are not complete");
  }
  parts_->hardware.advance_to(now_);
  parts_->network.set_time({kStart.wall_at(now_), now_});
  apply_kills();
  parts_->robot.step();
  parts_->monitor.update();
  parts_->goal.publish(now_, record().arrivals.size());
  parts_->network.deliver();
  now_ += kStep;
  return !is_over();
}

const TrialRecord& Trial::record() const {
  return parts_->monitor.record();
}

bool Trial::is_over() const {
  if (!record().started) {
    if (now_ >= kLatestStart) {
      throw std::runtime_error("no scan within a minute");
    }
    return false;
  }
  return now_ > *record().started + setup_.duration || has_arrived() || has_explored() ||
         has_failed();
}

bool Trial::has_arrived() const {
  const std::size_t num_goals = setup_.world.goals.size();
  if (setup_.world.task.arrival_radius_m) {
    return record().reached.has_value();
  }
  return num_goals > 0 && record().arrivals.size() >= num_goals &&
         now_ > record().arrivals[num_goals - 1] + kTimeAfterArrival;
}

bool Trial::has_explored() const {
  return parts_->exploration && parts_->exploration->record().home &&
         now_ > *parts_->exploration->record().home + kTimeAfterArrival;
}

// Whether the trial has failed by the rules of the world's task.
bool Trial::has_failed() const {
  const sim::Task& task = setup_.world.task;
  const TruthSample& last = record().truth.back();
  const bool is_late = task.time_limit_s && record().moved &&
                       now_ > *record().moved + time::from_seconds(*task.time_limit_s);
  return is_late || (task.ends_at_contact && last.contacts.collisions + last.contacts.bumps > 0);
}

void Trial::apply_kills() {
  for (const Kill& kill : setup_.kills) {
    if (now_ == kill.begin) {
      parts_->robot.kill(kill.process);
    } else if (now_ == kill.begin + kill.duration) {
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
    throw std::system_error(parts_->network.failure(), (dir_ / kLog).string() + ": cannot write");
  }
  return {.record = record(),
          .observed_voxels = parts_->monitor.observed_voxels(),
          .brake_events = parts_->monitor.brake_latency().events(),
          .exploration =
              parts_->exploration ? std::optional(parts_->exploration->record()) : std::nullopt,
          .num_evaded = parts_->monitor.brake_latency().num_evaded(),
          .num_masked = parts_->monitor.brake_latency().num_masked(),
          .processes = parts_->robot.report()};
}

void remove_logs(const std::filesystem::path& dir) {
  for (const char* log : {kLog, kLevelLaserLog}) {
    std::error_code ignored;  // another trial here would report it
    std::filesystem::remove(dir / log, ignored);
  }
}

std::set<std::string> omitted_processes(const TrialSetup& setup) {
  std::set<std::string> names = setup.without;
  if (!setup.explores) {
    names.insert("explorer");
  }
  return names;
}

StoppingZone stopping_zone(const TrialSetup& setup) {
  const sim::BodyParams& body = setup.params.sim.model.body;
  return {.footprint = {.half_length_m = 0.5 * body.length_m, .half_width_m = 0.5 * body.width_m},
          .braking = setup.params.navigator.robot.braking,
          .detection = setup.params.pitch_controller.detection};
}

}  // namespace nodmap::trial
