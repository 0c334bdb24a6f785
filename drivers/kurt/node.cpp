// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/node.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/geometry/se3.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "common/node/stop_sender.hpp"
#include "nodmap/base_sensors_t.hpp"

namespace nodmap::kurt {
namespace {

constexpr time::Duration kSensorsPeriod = 50ms;
// Older readings are not published, because their readers take them for as new as the message. The
// base sends each 15 times a second. At 1.8 m/s the robot drives 0.18 m meanwhile, less than by
// which the navigator lets a reading differ from its map.
constexpr time::Duration kPublishedFor = 100ms;
// Whoever has switched the base off, or works at it, does not expect it to drive off when it is
// back after this long. The driver tries to reopen a port 0.1, 0.3, 0.7, 1.5, 3.1 and 6.3 s after
// its loss, so that a plug must be back within 3.1 s.
constexpr time::Duration kLongAbsence = 5s;
// A command is 22 bytes; a line that does not accept them in this time is stuck.
constexpr time::Duration kWriteTimeout = 5ms;
constexpr time::Duration kShutdownTimeout = 50ms;
// Variance of what wheels cannot measure: height (m^2), roll and pitch (rad^2).
constexpr double kUnknownVariance = 1e6;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): characters are bytes
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// The value; null if it is too old.
template <class Value>
const Value* fresh(const std::optional<Received<Value>>& received, time::SteadyTime steady) {
  return received && steady - received->at <= kPublishedFor ? &received->value : nullptr;
}

float range_or_nan(std::optional<double> range_m) {
  return range_m ? static_cast<float>(*range_m) : kNan;
}

// Writes the covariance of x, y, yaw as that of x, y, z, roll, pitch, yaw.
void write_covariance(const Eigen::Matrix3d& covariance, double (&out)[6][6]) {
  constexpr int kAt[3] = {0, 1, 5};
  for (const int unknown : {2, 3, 4}) {
    out[unknown][unknown] = kUnknownVariance;
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      out[kAt[row]][kAt[column]] = covariance(row, column);
    }
  }
}

nodmap::base_sensors_t to_message(const BaseSensors& sensors, const time::Moment& now) {
  nodmap::base_sensors_t message{};
  message.utime = time::to_utime(now.wall);
  for (std::size_t i = 0; i < kInfraredCount; ++i) {
    const int* raw = fresh(sensors.infrared_raw[i], now.steady);
    message.infrared_raw[i] = raw != nullptr ? *raw : -1;
    message.infrared_m[i] = raw != nullptr ? range_or_nan(infrared_range_m(*raw)) : kNan;
  }
  const int* sonar_raw = fresh(sensors.sonar_raw, now.steady);
  message.sonar_raw = sonar_raw != nullptr ? *sonar_raw : -1;
  message.sonar_m = sonar_raw != nullptr ? range_or_nan(sonar_range_m(*sonar_raw)) : kNan;
  const Tilt* tilt = fresh(sensors.tilt, now.steady);
  message.roll_rad = tilt != nullptr ? static_cast<float>(tilt->roll_rad) : kNan;
  message.pitch_rad = tilt != nullptr ? static_cast<float>(tilt->pitch_rad) : kNan;
  const Gyro* gyro = fresh(sensors.gyro, now.steady);
  message.gyro_yaw_rad = gyro != nullptr ? static_cast<float>(gyro->yaw_rad) : kNan;
  message.gyro_variance_rad2 = gyro != nullptr ? static_cast<float>(gyro->variance_rad2) : kNan;
  const MotorCurrents* currents = fresh(sensors.motor_currents, now.steady);
  message.motor_current_left_a = currents != nullptr ? static_cast<float>(currents->left_a) : kNan;
  message.motor_current_right_a =
      currents != nullptr ? static_cast<float>(currents->right_a) : kNan;
  return message;
}

const char* describe(KurtState state, bool is_contested) {
  switch (state) {
    case KurtState::kNoLine:
      return "the serial line is not open";
    case KurtState::kNoBus:
      return "the CAN bus is not open: the adapter has not answered";
    case KurtState::kNoBase:
      return "no plausible encoder frames: is the base switched on?";
    case KurtState::kLate:
      return "the base answers late: the robot is stationary until it answers in time";
    case KurtState::kNoDrive:
      return is_contested ? "two processes send DRIVE: the robot is stationary until one has ended"
                          : "no DRIVE: the robot is stationary";
    case KurtState::kDriving:
      break;
  }
  return "";
}

}  // namespace

KurtNode::KurtNode(node::Context& context, const KurtParams& params,
                   serial::SerialLink::Opener open, std::function<time::Moment()> clock)
    : context_(context),
      kurt_(params),
      link_("base", std::move(open),
            {.opened = [this](const time::Moment& now) { kurt_.connected(now); },
             .received = [this](std::span<const std::uint8_t> bytes,
                                const time::Moment& now) { receive(bytes, now); },
             .lost = [this] { kurt_.disconnected(); }}),
      clock_(std::move(clock)),
      stop_latch_("its start"),
      base_seen_(clock_().steady) {
  context_.bus.subscribe<nodmap::drive_t>(
      "DRIVE", [this](const nodmap::drive_t& message) { on_drive(message); });
  context_.bus.subscribe<nodmap::stop_t>(
      "STOP", [this](const nodmap::stop_t& message) { on_stop(message); });
}

KurtNode::~KurtNode() {
  KurtNode::finish();
}

void KurtNode::refuse_former_releases() {
  constexpr time::Duration kDelay = 200ms;  // of a message, at most
  releases_count_from_ =
      clock_().steady + node::StopSender::kNumCopies * node::StopSender::kPeriod + kDelay;
}

void KurtNode::finish() {
  // Failure is acceptable: the base stops by itself when it receives nothing.
  link_.write(bytes_of(Kurt::shutdown_command()), clock_(), {.timeout = kShutdownTimeout});
  link_.end();
}

void KurtNode::spin_once() {
  const time::Moment now = clock_();
  link_.poll(now);
  stop_on_alarm();
  stop_on_return(now);
  count_losses(now);
  if (now.steady >= next_control_) {
    // Keeps to the grid of control periods, unless it is more than a period late.
    next_control_ = std::max(next_control_, now.steady - kControlPeriod) + kControlPeriod;
    send(now);
  }
  if (now.steady >= next_sensors_) {
    next_sensors_ = now.steady + kSensorsPeriod;
    publish_sensors(now);
  }
  if (const auto message = stop_repeater_.repeat_if_due(stop_latch_.stopped_by(), now)) {
    context_.bus.publish("STOP", *message);
  }
  log_change(now);
}

void KurtNode::receive(std::span<const std::uint8_t> bytes, const time::Moment& now) {
  for (const OdometrySample& sample : kurt_.receive(bytes, now)) {
    publish_odometry(sample);
  }
}

void KurtNode::send(const time::Moment& now) {
  if (!link_.is_open()) {
    return;
  }
  const std::string text = kurt_.control(now);
  if (!text.empty()) {
    link_.write(bytes_of(text), now, {.timeout = kWriteTimeout});
  }
  if (kurt_.wants_new_port()) {
    link_.give_up(now, lack(KurtState::kNoBus));
  }
}

std::array<int, 2> KurtNode::poll_handles() {
  return {link_.poll_handle(), -1};
}

time::Duration KurtNode::wait() const {
  return std::max(next_control_ - clock_().steady, time::Duration{});
}

void KurtNode::on_drive(const nodmap::drive_t& message) {
  // While STOP holds, every DRIVE counts as zero: the robot brakes and stays stationary.
  const DriveCommand wanted = stop_latch_.is_stopped()
                                  ? DriveCommand{}
                                  : DriveCommand{message.forward_mps, message.yaw_rate_rad_s};
  const time::Moment now = clock_();
  const bus::Origin& origin = context_.bus.origin();
  const DriveRequest request{wanted, time::from_utime(message.utime),
                             time::from_us(message.valid_us), origin.sender,
                             now.steady - origin.arrived};
  const DriveStatus status = kurt_.drive(request, now);
  if (status == DriveStatus::kObeyed) {
    context_.counts.use();
    stop_on_new_driver(request.sender);
  } else {
    context_.counts.reject(name_of(status));
  }
}

void KurtNode::on_stop(const nodmap::stop_t& message) {
  if (stop_repeater_.is_own(message)) {
    return;
  }
  if (message.is_stopped == 0 && clock_().steady < releases_count_from_) {
    context_.counts.reject("release_from_before_the_start");
    return;
  }
  context_.counts.use();
  // Also while the robot is free: whoever sends next has been released.
  if (stop_latch_.is_new_release(message)) {
    driver_.reset();
  }
  const node::StopLatch::Change change = stop_latch_.take(message);
  if (change == node::StopLatch::Change::kStopped) {
    kurt_.brake();  // not only with the next DRIVE, which may not come
  }
  if (change != node::StopLatch::Change::kNone) {
    log::get().info("{} by {}", stop_latch_.is_stopped() ? "stopped" : "free to drive",
                    node::read_name(message.requested_by));
  }
}

// Stops the robot as a STOP message does, until it is released.
void KurtNode::stop_on_alarm() {
  if (const std::optional<Alarm> alarm = kurt_.take_alarm(); alarm && !stop_latch_.is_stopped()) {
    stop_latch_.stop(name_of(*alarm));
    log::get().warn("stopped by {}", *stop_latch_.stopped_by());
  }
}

// Stops the robot if DRIVE comes from a process other than the one obeyed since the release. A
// navigator that has been restarted knows neither the goal nor whether the robot was at it, nor
// which ground it had seen: a robot at its goal would drive off.
void KurtNode::stop_on_new_driver(const bus::Sender& sender) {
  if (stop_latch_.is_stopped()) {
    return;
  }
  if (driver_ && *driver_ != sender) {
    stop_latch_.stop("a new sender of DRIVE");
    kurt_.brake();
    log::get().warn("stopped by {}", *stop_latch_.stopped_by());
  }
  driver_ = sender;
}

// Stops the robot if its base, or this process, was absent for long. The base counts as present
// until kBlind after its last encoder frame.
void KurtNode::stop_on_return(const time::Moment& now) {
  if (kurt_.state(now.steady) < KurtState::kLate) {
    return;
  }
  const time::Duration absence = now.steady - std::exchange(base_seen_, now.steady);
  if (absence >= kLongAbsence - kBlind && !stop_latch_.is_stopped()) {
    stop_latch_.stop("the return of its base");
    kurt_.brake();
    log::get().warn("stopped by {}", *stop_latch_.stopped_by());
  }
}

void KurtNode::count_losses(const time::Moment& now) {
  const KurtCounts& base = kurt_.counts();
  const std::int64_t lost = base.encoder_lost + base.encoder_implausible;
  encoder_loss_.take(lost, base.encoder_frames - base.encoder_implausible, now.steady);
  context_.counts.lose(lost - std::exchange(reported_lost_, lost));
}

void KurtNode::publish_odometry(const OdometrySample& sample) {
  const OdometryState& state = sample.state;
  nodmap::odometry_t message =
      node::write_odometry(sample.stamp, geometry::to_se3(state.T_odom_base));
  message.odometry_seq = odometry_seq_++;
  message.forward_mps = state.forward_mps;
  message.yaw_rate_rad_s = state.yaw_rate_rad_s;
  write_covariance(state.covariance, message.pose_covariance);
  context_.bus.publish("ODOMETRY", message);
}

void KurtNode::publish_sensors(const time::Moment& now) {
  const KurtState state = kurt_.state(now.steady);
  if (state == KurtState::kDriving || state == KurtState::kNoDrive) {
    nodmap::base_sensors_t message = to_message(kurt_.sensors(), now);
    message.sensors_seq = sensors_seq_++;
    context_.bus.publish("BASE_SENSORS", message);
  }
}

void KurtNode::log_change(const time::Moment& now) {
  const KurtState state = kurt_.state(now.steady);
  const char* text =
      state < KurtState::kNoDrive ? lack(state) : describe(state, kurt_.is_contested(now.steady));
  const KurtState before = std::exchange(logged_state_, state);
  const bool is_new = text != std::exchange(logged_text_, text);
  if (state > before && is_new) {  // closer to driving
    log::get().info("{}", state == KurtState::kDriving ? "obeying DRIVE" : text);
  } else if (state < before && is_new &&
             state != KurtState::kNoLine) {  // the loss of the line has been logged by the link
    log::get().warn("{}", text);
  }
  if (kurt_.session().lacks_flags() && !std::exchange(is_lack_of_flags_logged_, true)) {
    log::get().warn("the adapter does not support F: errors on the CAN bus are not reported");
  }
}

nlohmann::json KurtNode::metrics() const {
  const KurtCounts& base = kurt_.counts();
  const SlcanCounts& lines = kurt_.slcan_counts();
  return {{"encoder_frames", base.encoder_frames},
          {"encoder_lost", base.encoder_lost},
          {"encoder_implausible", base.encoder_implausible},
          {"encoder_gaps", base.encoder_gaps},
          {"can_frames", lines.frames},
          {"lines_malformed", lines.malformed},
          {"lines_too_long", lines.too_long},
          {"commands_refused", lines.refused},
          {"gyro_used", kurt_.gyro().counts().used},
          {"gyro_refused", kurt_.gyro().counts().refused},
          {"gyro_silences", kurt_.gyro().counts().silences},
          {"delay_ms", time::seconds(kurt_.session().delay()) * 1e3},
          {"bus_restarts", kurt_.session().restarts()},
          {"reconnects", link_.reconnects()}};
}

node::Health KurtNode::health() const {
  const time::SteadyTime now = clock_().steady;
  const KurtState state = kurt_.state(now);
  const bool is_contested = kurt_.is_contested(now);
  switch (state) {
    case KurtState::kNoLine:
      return {node::HealthState::kFailed, link_.error()};
    case KurtState::kNoBus:
    case KurtState::kNoBase:
    case KurtState::kLate:
      return {node::HealthState::kFailed, lack(state)};
    case KurtState::kNoDrive:
      if (is_contested || !stop_latch_.is_stopped()) {
        return {is_contested ? node::HealthState::kFailed : node::HealthState::kDegraded,
                describe(state, is_contested)};
      }
      break;
    case KurtState::kDriving:
      break;
  }
  if (const auto& stopped_by = stop_latch_.stopped_by()) {
    return {node::HealthState::kDegraded,
            "stopped by " + *stopped_by + ": stationary until released (nodmap-stop --go)"};
  }
  if (std::string reason = shortcoming(); !reason.empty()) {
    return {node::HealthState::kDegraded, std::move(reason)};
  }
  return {};
}

const char* KurtNode::lack(KurtState state) const {
  if (state == KurtState::kLate && kurt_.session().is_unanswered()) {
    return "the adapter answers neither F nor V in time, so frames may be late: the robot is "
           "stationary";
  }
  const bool is_base_silent = state == KurtState::kNoBus && kurt_.session().is_mute();
  return describe(is_base_silent ? KurtState::kNoBase : state, false);
}

std::string KurtNode::shortcoming() const {
  if (const std::optional<Alarm> alarm = kurt_.lasting_alarm()) {
    return std::string("only creeps because of ") + name_of(*alarm);
  }
  if ((kurt_.session().flags() & (kErrorPassive | kBusError)) != 0) {
    return "errors on the CAN bus: check cable and termination";
  }
  if (encoder_loss_.loses_many()) {
    return "many encoder frames are lost: check the line";
  }
  if (const std::string_view fault = fault_of(kurt_.gyro().use()); !fault.empty()) {
    return "the heading comes from the wheels alone: " + std::string(fault);
  }
  return "";
}

}  // namespace nodmap::kurt
