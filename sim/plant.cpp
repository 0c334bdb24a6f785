// SPDX-License-Identifier: BSD-3-Clause
#include "sim/plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/collision.hpp"
#include "sim/ground.hpp"
#include "sim/ray_caster.hpp"

namespace nodmap::sim {
namespace {

constexpr std::int64_t kStepUs = 1000;
constexpr double kStepS = 1e-6 * kStepUs;
/// More than 100 ms, and what a device may lag behind.
constexpr std::size_t kHistory = 128;
/// Below, the robot counts as standing: who touches it has walked into it.
constexpr double kStandingMps = 0.05;
/// Sets the wheels' random numbers apart from the laser's.
constexpr std::uint64_t kSlipStream = 0x9e3779b97f4a7c15;

/// Everything that changes, at the end of one step.
struct Step {
  std::int64_t time_us = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  PitchState pitch;
  WheelTravel travel;
  std::vector<ActorState> actors;  // those that are there
};

geometry::SE3 pose_between(const Step& from, const Step& to, double fraction) {
  // Within a millisecond the chord is as good as the arc.
  const Eigen::Vector4d q =
      from.orientation.coeffs() + fraction * (to.orientation.coeffs() - from.orientation.coeffs());
  return geometry::make_se3(from.position + fraction * (to.position - from.position),
                            Eigen::Quaterniond(q).normalized());
}

double between(double from, double to, double fraction) {
  return from + fraction * (to - from);
}

}  // namespace

struct Plant::State {
  State(World world_in, const PlantParams& params_in, std::uint64_t seed)
      : world(std::move(world_in)),
        params(params_in),
        caster(world),
        ground(world, params),
        collision(world, params),
        body(params, world.T_world_start, seed ^ kSlipStream),
        servo(params),
        rangefinder(params, seed) {
    remember();
  }

  void step();
  void drive();
  void meet_actors(const geometry::SE2& T_world_before, double speed_mps);
  void remember();
  [[nodiscard]] Eigen::Quaterniond orientation() const;
  // Contacts are known by number: things, the edge of what the robot drives on, actors.
  [[nodiscard]] std::size_t edge() const { return collision.size(); }
  [[nodiscard]] double distance(std::size_t contact) const;
  [[nodiscard]] ActorState state_of(const Actor& actor) const {
    return {actor.position(newest_s()), actor.radius_m, actor.height_m};
  }
  [[nodiscard]] double newest_s() const { return 1e-6 * static_cast<double>(newest_us); }
  [[nodiscard]] const Step& step_at(std::int64_t time_us) const {
    return history[static_cast<std::size_t>(time_us / kStepUs) % kHistory];
  }
  [[nodiscard]] BodyPlace place() const {
    const double slope = support.normal.head<2>().norm() / support.normal.z();
    const double corner_m = 0.5 * std::hypot(params.body_length_m, params.body_width_m);
    return {body.pose(), support.height_m, corner_m * slope};
  }
  /// The steps before and after a time, and how far it is between them.
  struct Moment {
    const Step& from;
    const Step& to;
    double fraction;
  };
  [[nodiscard]] Moment moment(std::int64_t time_us) const;

  World world;
  PlantParams params;
  RayCaster caster;
  Ground ground;
  Collision collision;
  RobotBody body;
  PitchServo servo;
  Rangefinder rangefinder;
  Support support;
  Contacts contacts;
  Eigen::Vector2d edge_met = Eigen::Vector2d::Zero();  // where the robot last came to that edge
  std::int64_t collisions = 0;
  std::int64_t bumps = 0;
  std::int64_t now_us = 0;
  std::int64_t newest_us = 0;  // the first full millisecond that is not before now
  WheelTravel travel_now;
  std::array<Step, kHistory> history;
};

void Plant::State::step() {
  newest_us += kStepUs;
  drive();
  contacts.end_those_apart([this](std::size_t thing) { return distance(thing); });
  remember();
}

double Plant::State::distance(std::size_t contact) const {
  if (contact < collision.size()) {
    return collision.distance(contact, place());
  }
  if (contact == edge()) {
    return (body.pose().translation() - edge_met).norm();
  }
  const Actor& actor = world.actors[contact - edge() - 1];
  return actor.is_there(newest_s()) ? collision.distance(state_of(actor), place())
                                    : std::numeric_limits<double>::infinity();
}

/// Moves the robot, unless something is in its way.
void Plant::State::drive() {
  const geometry::SE2 T_world_before = body.pose();
  body.step(kStepS);
  const double corner_m = 0.5 * std::hypot(params.body_length_m, params.body_width_m);
  const double speed_mps =
      std::abs(body.forward_mps()) + corner_m * std::abs(body.yaw_rate_rad_s());

  bool blocked = false;
  const auto hit = [&](std::size_t thing) {
    blocked = true;
    collisions += contacts.begin(thing) ? 1 : 0;
  };
  for (const std::size_t thing : collision.touched(place())) {
    hit(thing);
  }
  const Support next = ground.at(body.pose().translation(), support.height_m);
  if (next.height_m < support.height_m - params.climb_height_m) {
    hit(edge());
    edge_met = body.pose().translation();
  }
  if (blocked) {
    body.hold_back(T_world_before);
  } else {
    support = next;
  }
  meet_actors(T_world_before, speed_mps);
}

void Plant::State::meet_actors(const geometry::SE2& T_world_before, double speed_mps) {
  for (std::size_t i = 0; i < world.actors.size(); ++i) {
    const Actor& actor = world.actors[i];
    if (!actor.is_there(newest_s())) {
      continue;
    }
    const ActorState state = state_of(actor);
    if (collision.distance(state, place()) > 0.0) {
      continue;
    }
    if (contacts.begin(edge() + 1 + i)) {
      ++(speed_mps < kStandingMps ? bumps : collisions);
    }
    // The robot may leave an actor, not drive into it.
    const double before_m = (T_world_before.translation() - state.position).norm();
    const double after_m = (body.pose().translation() - state.position).norm();
    if (after_m <= before_m) {
      body.hold_back(T_world_before);
    }
  }
}

Eigen::Quaterniond Plant::State::orientation() const {
  const Eigen::AngleAxisd yaw(body.pose().yaw, Eigen::Vector3d::UnitZ());
  // About x a positive turn lifts the left side, about y it lowers the front.
  const Eigen::AngleAxisd roll(-body.lean_left_rad(), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd pitch(-body.lean_up_rad(), Eigen::Vector3d::UnitY());
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), support.normal) * yaw *
         pitch * roll;
}

void Plant::State::remember() {
  Step& step = history[static_cast<std::size_t>(newest_us / kStepUs) % kHistory];
  const geometry::SE2& pose = body.pose();
  step.time_us = newest_us;
  step.position = {pose.x, pose.y, support.height_m};
  step.orientation = orientation();
  step.pitch = servo.at(newest_s());
  step.travel = body.travel();
  step.actors.clear();
  for (const Actor& actor : world.actors) {
    if (actor.is_there(newest_s())) {
      step.actors.push_back(state_of(actor));
    }
  }
}

Plant::State::Moment Plant::State::moment(std::int64_t time_us) const {
  const std::int64_t after_us = std::min(newest_us, (time_us / kStepUs + 1) * kStepUs);
  const Step& to = step_at(after_us);
  const Step& from = after_us > 0 ? step_at(after_us - kStepUs) : to;
  const double fraction = 1e-3 * static_cast<double>(time_us - from.time_us);
  return {from, to, fraction};
}

Plant::Plant(const World& world, const PlantParams& params, std::uint64_t seed)
    : state_(std::make_unique<State>(world, params, seed)) {}

Plant::~Plant() = default;

void Plant::advance_to(std::int64_t now_us) {
  if (now_us < state_->now_us) {
    throw std::invalid_argument("the plant's time does not go back");
  }
  state_->now_us = now_us;
  while (state_->newest_us < now_us) {
    state_->step();
  }
  const State::Moment now = state_->moment(now_us);
  state_->travel_now = {between(now.from.travel.left_m, now.to.travel.left_m, now.fraction),
                        between(now.from.travel.right_m, now.to.travel.right_m, now.fraction)};
}

std::int64_t Plant::now_us() const {
  return state_->now_us;
}

Echo Plant::measure(double angle_rad, std::int64_t time_us) {
  constexpr std::int64_t kOldestUs = static_cast<std::int64_t>(kHistory - 2) * kStepUs;
  if (time_us > state_->now_us || time_us < state_->newest_us - kOldestUs) {
    throw std::out_of_range("a beam is measured up to 100 ms after it was fired");
  }
  // Before the start everything was as at the start.
  const State::Moment at = state_->moment(std::max<std::int64_t>(time_us, 0));
  const double pitch_rad = between(at.from.pitch.pitch_rad, at.to.pitch.pitch_rad, at.fraction);
  geometry::SE3 T_base_laser = geometry::SE3::Identity();
  T_base_laser.translation() << state_->params.mount_x_m, 0.0, state_->params.mount_z_m;
  T_base_laser.linear() = geometry::pitch_rotation(pitch_rad);
  const geometry::SE3 T_world_laser = pose_between(at.from, at.to, at.fraction) * T_base_laser;
  // In a millisecond nobody walks as far as a range is uncertain.
  return state_->rangefinder.measure(state_->caster, T_world_laser, angle_rad, at.to.actors);
}

void Plant::set_pitch_goal(const PitchGoal& goal) {
  state_->servo.set_goal(goal, state_->newest_s());
}

void Plant::set_pitch_torque(bool on) {
  state_->servo.set_torque(on, state_->newest_s());
}

void Plant::jam_pitch(bool jammed) {
  state_->servo.set_jammed(jammed, state_->newest_s());
}

double Plant::pitch_rad() const {
  const State::Moment now = state_->moment(state_->now_us);
  return between(now.from.pitch.pitch_rad, now.to.pitch.pitch_rad, now.fraction);
}

double Plant::pitch_rate_rad_s() const {
  const State::Moment now = state_->moment(state_->now_us);
  return between(now.from.pitch.rate_rad_s, now.to.pitch.rate_rad_s, now.fraction);
}

void Plant::set_wheel_speeds(const WheelSpeeds& goal) {
  state_->body.set_wheel_speeds(goal);
}

void Plant::brake_wheels() {
  state_->body.brake();
}

const WheelTravel& Plant::wheel_travel() const {
  return state_->travel_now;
}

WheelSpeeds Plant::wheel_speeds() const {
  return state_->body.wheel_speeds();
}

Truth Plant::truth() const {
  const State::Moment now = state_->moment(state_->now_us);
  Truth truth;
  truth.T_world_base = pose_between(now.from, now.to, now.fraction);
  truth.forward_mps = state_->body.forward_mps();
  truth.yaw_rate_rad_s = state_->body.yaw_rate_rad_s();
  truth.pitch_rad = pitch_rad();
  truth.pitch_rate_rad_s = pitch_rate_rad_s();
  truth.collisions = state_->collisions;
  truth.bumps = state_->bumps;
  truth.actors = now.to.actors;
  truth.clearance_m = state_->collision.clearance_m(state_->place());
  for (const ActorState& actor : truth.actors) {
    truth.clearance_m =
        std::min(truth.clearance_m, state_->collision.distance(actor, state_->place()));
  }
  return truth;
}

}  // namespace nodmap::sim
