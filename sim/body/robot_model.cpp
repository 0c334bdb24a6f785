// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/robot_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/body/collision.hpp"
#include "sim/body/contacts.hpp"
#include "sim/body/crowd.hpp"
#include "sim/body/ground.hpp"
#include "sim/body/motion_history.hpp"
#include "sim/world/ray_caster.hpp"

namespace nodmap::sim {
namespace {

constexpr double kMotionStepS = time::seconds(MotionHistory::kStep);
// Makes the wheels' random numbers independent of the laser's.
constexpr std::uint64_t kSlipStream = 0x9e3779b97f4a7c15;

// Heights of the outermost wheels, metres: front left, front right, rear left, rear right.
using WheelHeights = std::array<double, 4>;

}  // namespace

struct RobotModel::State {
  State(World world_in, const RobotModelParams& params_in, std::uint64_t seed)
      : world(std::move(world_in)),
        params(params_in),
        caster(world),
        ground(world, params.body),
        collision(world, params.body),
        crowd(world, params.body),
        base(params.drive, world.T_world_start, seed ^ kSlipStream),
        servo(params.servo),
        rangefinder(params.laser, seed),
        contacts(collision, crowd) {
    wheel_heights_m.fill(world.start_height_m);
    stand();
    save_step({});
  }

  void step();
  void drive();
  [[nodiscard]] bool touch_obstacles(double speed_mps);
  [[nodiscard]] std::optional<WheelHeights> roll(double speed_mps);
  void stand();
  void touch_actors(const geometry::SE2& T_world_before, double speed_mps);
  void save_step(time::SteadyTime instant);
  [[nodiscard]] Eigen::Quaterniond orientation() const;
  [[nodiscard]] Moment present() const { return history.at(now); }
  // The end of the last step, the first full millisecond that is not before now.
  [[nodiscard]] double newest_s() const {
    return time::seconds(history.newest().time_since_epoch());
  }
  [[nodiscard]] double corner_m() const {
    return 0.5 * std::hypot(params.body.length_m, params.body.width_m);
  }
  // The contact point of an outermost wheel, in base. `i` as in WheelHeights.
  [[nodiscard]] Eigen::Vector2d wheel(std::size_t i) const {
    return {(i < 2 ? 0.5 : -0.5) * params.body.wheelbase_m,
            (i % 2 == 0 ? 0.5 : -0.5) * params.drive.axis_length_m};
  }
  [[nodiscard]] BodyPose body_pose() const {
    const double slope = support.normal.head<2>().norm() / support.normal.z();
    return {base.T_world_base(), support.height_m, corner_m() * slope};
  }

  World world;
  RobotModelParams params;
  RayCaster caster;
  Ground ground;
  Collision collision;
  Crowd crowd;
  SkidSteerBase base;
  PitchServo servo;
  Rangefinder rangefinder;
  Support support;
  WheelHeights wheel_heights_m{};
  Contacts contacts;
  time::SteadyTime now{};
  WheelTravel travel_now;
  MotionHistory history;
};

void RobotModel::State::step() {
  const time::SteadyTime instant = history.newest() + MotionHistory::kStep;
  crowd.advance(time::seconds(instant.time_since_epoch()), base.T_world_base());
  drive();
  contacts.end_separated(body_pose());
  save_step(instant);
}

// Moves the robot, unless an obstacle, a step or an edge blocks it.
void RobotModel::State::drive() {
  const geometry::SE2 T_world_before = base.T_world_base();
  base.step(kMotionStepS);
  // An upper bound of the speed of all points of the body.
  const double speed_mps =
      std::abs(base.forward_mps()) + corner_m() * std::abs(base.yaw_rate_rad_s());
  const bool touches = touch_obstacles(speed_mps);
  const std::optional<WheelHeights> heights_m = roll(speed_mps);
  if (touches || !heights_m) {
    base.block(T_world_before);
  } else {
    wheel_heights_m = *heights_m;
    stand();
  }
  touch_actors(T_world_before, speed_mps);
}

// Counts contacts with obstacles. Returns whether the body touches any.
bool RobotModel::State::touch_obstacles(double speed_mps) {
  const std::vector<std::size_t> touched = collision.touched(body_pose());
  for (const std::size_t obstacle : touched) {
    contacts.touch_obstacle(obstacle, speed_mps);
  }
  return !touched.empty();
}

// Rolls the wheels to where the base is now, and counts contacts with steps up and edges. Returns
// the heights of the wheels; empty if one of them is blocked.
std::optional<WheelHeights> RobotModel::State::roll(double speed_mps) {
  if (ground.is_flat()) {
    return wheel_heights_m;
  }
  bool is_blocked = false;
  WheelHeights heights_m{};
  for (std::size_t i = 0; i < heights_m.size(); ++i) {
    const WheelContact contact = ground.roll(base.T_world_base() * wheel(i), wheel_heights_m[i]);
    if (contact.blocking_object) {
      is_blocked = true;
      contacts.touch_obstacle(*contact.blocking_object, speed_mps);
    } else if (contact.height_m < wheel_heights_m[i] - params.body.climb_height_m) {
      is_blocked = true;
      contacts.touch_edge(base.T_world_base(), speed_mps);
    }
    heights_m[i] = contact.height_m;
  }
  return is_blocked ? std::nullopt : std::optional(heights_m);
}

// Computes the height and tilt of the body from the heights of the wheels.
void RobotModel::State::stand() {
  if (ground.is_flat()) {
    return;
  }
  const auto& [front_left, front_right, rear_left, rear_right] = wheel_heights_m;
  const double up_ahead =
      0.5 * (front_left + front_right - rear_left - rear_right) / params.body.wheelbase_m;
  const double up_left =
      0.5 * (front_left + rear_left - front_right - rear_right) / params.drive.axis_length_m;
  const Eigen::Vector2d rise = base.T_world_base().rotation() * Eigen::Vector2d(up_ahead, up_left);
  support.height_m = 0.25 * (front_left + front_right + rear_left + rear_right);
  support.normal = Eigen::Vector3d(-rise.x(), -rise.y(), 1.0).normalized();
  base.set_slope(up_ahead);
}

// Counts contacts with actors. The robot may move away from an actor that it touches, and along
// it, but not farther into it.
void RobotModel::State::touch_actors(const geometry::SE2& T_world_before, double speed_mps) {
  constexpr double kRoundingM = 1e-12;
  const BodyPose after = body_pose();
  BodyPose before = after;
  before.T_world_base = T_world_before;
  bool is_blocked = false;
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    if (!crowd.is_present(i)) {
      continue;
    }
    const ActorState state = crowd.state(i);
    if (collision.distance(state, after) > 0.0) {
      continue;
    }
    // Only what the robot's own motion changes; a corner also approaches in a rotation on the spot.
    const bool approaches =
        collision.axis_distance(state, after) < collision.axis_distance(state, before) - kRoundingM;
    contacts.touch_actor(i, speed_mps, approaches);
    is_blocked = is_blocked || approaches;
  }
  if (is_blocked) {
    base.block(T_world_before);
  }
}

Eigen::Quaterniond RobotModel::State::orientation() const {
  const Eigen::AngleAxisd yaw(base.T_world_base().yaw, Eigen::Vector3d::UnitZ());
  // A positive rotation about x lifts the left side, one about y lowers the front.
  const Eigen::AngleAxisd roll(-base.tilt_left_rad(), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd pitch(-base.tilt_up_rad(), Eigen::Vector3d::UnitY());
  return geometry::rotation_between(Eigen::Vector3d::UnitZ(), support.normal) * yaw * pitch * roll;
}

void RobotModel::State::save_step(time::SteadyTime instant) {
  Step& step = history.add(instant);
  const geometry::SE2& T_world_base = base.T_world_base();
  step.position = {T_world_base.x, T_world_base.y, support.height_m};
  step.orientation = orientation();
  step.pitch = servo.at(newest_s());
  step.travel = base.travel();
  crowd.copy_present(step.actors);
}

RobotModel::RobotModel(const World& world, const RobotModelParams& params, std::uint64_t seed)
    : state_(std::make_unique<State>(world, params, seed)) {}

RobotModel::~RobotModel() = default;

void RobotModel::advance_to(time::SteadyTime now) {
  if (now < state_->now) {
    throw std::invalid_argument("simulated time must not go back");
  }
  state_->now = now;
  while (state_->history.newest() < now) {
    state_->step();
  }
  state_->travel_now = state_->history.at(now).travel();
}

time::SteadyTime RobotModel::now() const {
  return state_->now;
}

Echo RobotModel::measure(double angle_rad, time::SteadyTime fired) {
  const MotionHistory& history = state_->history;
  if (fired > state_->now || fired < history.oldest()) {
    throw std::out_of_range("a beam can be measured only up to 100 ms after it was fired");
  }
  // Before time 0 the robot was where it started.
  const Moment moment = history.at(std::max(fired, time::SteadyTime{}));
  const ServoParams& servo = state_->params.servo;
  const Eigen::Vector3d p_head_mirror(servo.mirror_forward_m, 0.0, servo.mirror_up_m);
  geometry::SE3 T_base_laser = geometry::SE3::Identity();
  T_base_laser.linear() = geometry::pitch_rotation(moment.pitch().pitch_rad);
  T_base_laser.translation() << servo.mount_x_m, 0.0, servo.mount_z_m;
  T_base_laser.translation() += T_base_laser.linear() * p_head_mirror;
  T_base_laser.rotate(Eigen::AngleAxisd(servo.laser_yaw_rad, Eigen::Vector3d::UnitZ()));
  T_base_laser.rotate(Eigen::AngleAxisd(servo.laser_roll_rad, Eigen::Vector3d::UnitX()));
  return state_->rangefinder.measure(state_->caster, moment.T_world_base() * T_base_laser,
                                     angle_rad, moment.actors());
}

void RobotModel::set_pitch_goal(const PitchGoal& goal) {
  state_->servo.set_goal(goal, state_->newest_s());
}

void RobotModel::set_pitch_torque(bool on) {
  state_->servo.set_torque(on, state_->newest_s());
}

void RobotModel::set_pitch_jammed(bool jammed) {
  state_->servo.set_jammed(jammed, state_->newest_s());
}

double RobotModel::pitch_rad() const {
  return state_->present().pitch().pitch_rad;
}

double RobotModel::pitch_rate_rad_s() const {
  return state_->present().pitch().rate_rad_s;
}

void RobotModel::set_wheel_speeds(const WheelSpeeds& goal) {
  state_->base.set_wheel_speeds(goal);
}

void RobotModel::brake_wheels() {
  state_->base.brake();
}

const WheelTravel& RobotModel::wheel_travel() const {
  return state_->travel_now;
}

WheelSpeeds RobotModel::wheel_speeds() const {
  return state_->base.wheel_speeds();
}

std::optional<double> RobotModel::distance_from(const Eigen::Vector3d& p_base, double yaw_rad,
                                                double max_range_m) const {
  const Moment now = state_->present();
  const geometry::SE3 T_world_base = now.T_world_base();
  const Eigen::Vector3d ahead(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  Ray ray{T_world_base * p_base, T_world_base.linear() * ahead};
  constexpr double kBeyondM = 1e-6;  // past a pane of glass, which reflects nothing
  for (double passed_m = 0.0; passed_m < max_range_m;) {
    const std::optional<Hit> hit = state_->caster.cast(ray, max_range_m - passed_m, now.actors());
    if (!hit || hit->reflectivity > 0.0) {
      return hit ? std::optional(passed_m + hit->distance_m) : std::nullopt;
    }
    ray.origin += (hit->distance_m + kBeyondM) * ray.direction;
    passed_m += hit->distance_m + kBeyondM;
  }
  return std::nullopt;
}

GroundTruth RobotModel::ground_truth() const {
  const Moment now = state_->present();
  GroundTruth truth;
  truth.T_world_base = now.T_world_base();
  truth.forward_mps = state_->base.forward_mps();
  truth.yaw_rate_rad_s = state_->base.yaw_rate_rad_s();
  truth.acceleration_mps2 = state_->base.acceleration_mps2();
  truth.pitch_rad = now.pitch().pitch_rad;
  truth.pitch_rate_rad_s = now.pitch().rate_rad_s;
  truth.contacts = state_->contacts.counts();
  truth.actors = now.actors();
  truth.person_clearance_m = std::numeric_limits<double>::infinity();
  for (const ActorState& actor : truth.actors) {
    truth.person_clearance_m =
        std::min(truth.person_clearance_m, state_->collision.distance(actor, state_->body_pose()));
  }
  truth.clearance_m =
      std::min(truth.person_clearance_m, state_->collision.clearance_m(state_->body_pose()));
  return truth;
}

}  // namespace nodmap::sim
