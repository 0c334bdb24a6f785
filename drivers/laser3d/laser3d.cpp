// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/laser3d.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/laser3d/servo/dynamixel_session.hpp"
#include "drivers/laser3d/servo/maestro.hpp"

namespace nodmap::laser3d {
namespace {

// The laser counts as blind after one period of the nod without readings, but not before this time,
// because a fast nod may miss a reading or two. In every nod the beams hit the floor or something
// on it; if they hit nothing, the laser is blind and the space only looks free. Waiting this long
// is safe: an obstacle just behind the beam may stay unseen for a whole nod anyway, and the robot
// keeps the distance that this requires.
constexpr time::Duration kShortestBlind = 1s;
// Two sweeps of 500 scans (6.7 s each), the slowest that the pitch controller commands, and a
// reserve. If the head nods even more slowly and looks at the open sky for longer, the robot stops.
constexpr time::Duration kLongestBlind = 15s;
constexpr double kNodReserve = 1.1;
// Fewer readings may be dust or the laser's own noise.
constexpr int kMinReadings = 10;

std::unique_ptr<ServoSession> make_servo(const Laser3dParams& params) {
  if (params.servo.kind == ServoKind::kMaestro) {
    return std::make_unique<MaestroSession>(params.servo);
  }
  return std::make_unique<DynamixelSession>(params.servo,
                                            params.robot.head.pitch_acceleration_rad_s2);
}

}  // namespace

Laser3d::Laser3d(const Laser3dParams& params)
    : params_(params),
      sick_(params.laser),
      // The bound on the drift allows for the motor's control to 75 Hz and for the rounded period
      // in the manual.
      mirror_sync_({.tick = kMirrorPeriod, .wrap_ticks = 256, .max_drift = 0.002}),
      servo_(make_servo(params)),
      nod_(params.nod, params.robot.head),
      joiner_(params.joiner),
      T_base_mount_(Eigen::Translation3d(params.robot.mount.x_m, params.robot.mount.y_m,
                                         params.robot.mount.z_m)) {}

Laser3dOutput Laser3d::laser_opened(time::SteadyTime now) {
  Laser3dOutput result;
  take(sick_.open(now), result);
  return result;
}

Laser3dOutput Laser3d::servo_opened(time::SteadyTime now) {
  Laser3dOutput result;
  take(servo_->open(now), now, result);
  return result;
}

void Laser3d::laser_lost() {
  sick_.close();
}

void Laser3d::servo_lost() {
  servo_->close();
  joiner_.forget_pitch();
}

Laser3dOutput Laser3d::receive_laser(ByteView bytes, time::SteadyTime now) {
  Laser3dOutput result;
  parser_.feed(bytes, now);
  while (const auto event = parser_.next()) {
    if (const auto* telegram = std::get_if<SickTelegram>(&*event)) {
      take(sick_.take(*telegram, now), result);
    } else if (std::holds_alternative<SickNak>(*event)) {
      sick_.take_nak(now);
    }
  }
  join(now, result);
  return result;
}

Laser3dOutput Laser3d::receive_servo(ByteView bytes, time::SteadyTime now) {
  Laser3dOutput result;
  take(servo_->receive(bytes, now), now, result);
  join(now, result);
  return result;
}

Laser3dOutput Laser3d::poll(time::SteadyTime now) {
  parser_.expire(now);
  Laser3dOutput result = receive_laser({}, now);
  take(sick_.poll(now), result);
  take(servo_->poll(now), now, result);
  if (!servo_->is_running()) {
    joiner_.forget_pitch();
  }
  watch_for_losses(now);
  return result;
}

bool Laser3d::command(const AreaOfInterest& area, time::SteadyTime decided) {
  return nod_.command(area, decided);
}

Laser3dOutput Laser3d::shut_down(time::SteadyTime now) {
  Laser3dOutput result;
  take(sick_.shut_down(now), result);
  return result;
}

void Laser3d::take(SickOutput output, Laser3dOutput& result) {
  if (output.baud) {
    parser_.reset(*output.baud);
  }
  if (output.baud || !output.send.empty()) {
    result.laser.push_back({output.baud, std::move(output.send)});
  }
  if (output.scan) {
    take_scan(*output.scan);
  }
}

void Laser3d::take(ServoOutput output, time::SteadyTime now, Laser3dOutput& result) {
  if (!output.send.empty()) {
    result.servo.push_back({std::nullopt, std::move(output.send)});
  }
  if (output.sample) {
    joiner_.add(*output.sample);
    const Nod::Aim aim = nod_.step(*output.sample, now);
    servo_->aim(aim.goal_rad, aim.speed_rad_s);
    result.pitch.push_back(
        {*output.sample, aim, nod_.sweep(), servo_->measures_pitch(), nod_.is_stalled()});
  }
}

void Laser3d::take_scan(const SickScan& scan) {
  note_quality(scan);
  const time::SteadyTime sent = sent_at(scan) + time::from_seconds(params_.laser.time_offset_s);
  if (params_.laser.interlaced) {
    joiner_.add(interlaced_revolution(scan, sent));
    return;
  }
  for (MirrorRevolution& revolution : mirror_revolutions(scan, params_.laser.variant, sent)) {
    joiner_.add(std::move(revolution));
  }
}

void Laser3d::note_quality(const SickScan& scan) {
  counts_.dazzled_beams += scan.num_dazzled;
  const double beams = std::max(1.0, static_cast<double>(scan.ranges_m.size()));
  dazzled_ratio_ = scan.num_dazzled / beams;
  unmeasured_ratio_ = (scan.num_dazzled + scan.num_unmeasured) / beams;
  status_ = scan.status;
  if (sees_something(scan)) {
    last_sight_ = scan.first_byte;
  }
}

bool Laser3d::sees_something(const SickScan& scan) const {
  // Readings outside the valid range do not count: a covered window gives readings of zero.
  const auto counts = [this](double range_m) {
    return range_m >= params_.laser.range_min_m && range_m <= params_.laser.range_max_m;
  };
  const auto readings = std::ranges::count_if(scan.ranges_m, counts);
  return readings >= kMinReadings;
}

bool Laser3d::is_blind(time::SteadyTime now) const {
  const auto nod_period =
      std::chrono::duration_cast<time::Duration>(kNodReserve * nod_.nod_period(now));
  return !last_sight_ || now - *last_sight_ > std::clamp(nod_period, kShortestBlind, kLongestBlind);
}

time::SteadyTime Laser3d::sent_at(const SickScan& scan) {
  if (!scan.indices) {
    return scan.first_byte;
  }
  if (connections_ != sick_.counts().connections) {
    mirror_sync_.reset();
  } else if (last_telegram_index_) {
    counts_.telegrams_missed +=
        static_cast<std::uint8_t>(scan.indices->telegram - *last_telegram_index_ - 1);
  }
  last_telegram_index_ = scan.indices->telegram;
  connections_ = sick_.counts().connections;
  return mirror_sync_.to_host(scan.indices->scan, scan.first_byte);
}

void Laser3d::join(time::SteadyTime now, Laser3dOutput& result) {
  while (std::optional<PitchedRevolution> pitched = joiner_.next(now)) {
    last_scan_ = now;
    if (is_blind(now)) {
      ++counts_.scans_blind;
      continue;
    }
    ++counts_.scans;
    result.scans.push_back(to_scan(std::move(*pitched)));
  }
  if (counts_.scans == 0) {
    dropped_at_start_ = joiner_.dropped();  // the laser was ready before the servo
  }
  counts_.scans_without_pitch = joiner_.dropped() - dropped_at_start_;
}

SteadyScan Laser3d::to_scan(PitchedRevolution pitched) {
  scan::Scan scan;
  scan.duration = pitched.revolution.last_beam - pitched.revolution.first_beam;
  scan.seq = scan_seq_++;
  const double sign = params_.laser.upside_down ? -1.0 : 1.0;
  scan.angle_first_rad = sign * pitched.revolution.angle_first_rad;
  scan.angle_step_rad = sign * pitched.revolution.angle_step_rad;
  scan.pitch_first_rad = pitched.pitch_first_rad;
  scan.pitch_last_rad = pitched.pitch_last_rad;
  scan.pitch_measured = servo_->measures_pitch();
  scan.range_min_m = params_.laser.range_min_m;
  scan.range_max_m = std::min(params_.laser.range_max_m, pitched.revolution.range_max_m);
  scan.T_base_mount = T_base_mount_;
  scan.mirror_offset_m = {params_.mirror.forward_m, 0.0, params_.mirror.up_m};
  scan.ranges_m = std::move(pitched.revolution.ranges_m);
  return {pitched.revolution.first_beam, std::move(scan)};
}

void Laser3d::watch_for_losses(time::SteadyTime now) {
  telegram_loss_.take(counts_.telegrams_missed, sick_.counts().scans, now);
  pitch_loss_.take(counts_.scans_without_pitch, counts_.scans + counts_.scans_blind, now);
}

node::Health Laser3d::health(time::SteadyTime now) const {
  using node::HealthState;
  if (std::string reason = failure(now); !reason.empty()) {
    return {HealthState::kFailed, std::move(reason)};
  }
  if (std::string reason = shortcoming(); !reason.empty()) {
    return {HealthState::kDegraded, std::move(reason)};
  }
  return {HealthState::kOk, "", false};
}

std::string Laser3d::failure(time::SteadyTime now) const {
  constexpr time::Duration kShortestNoScan = 500ms;
  if (!servo_->is_running()) {
    return "servo: " + servo_->last_error();
  }
  if (!sick_.last_error().empty()) {
    return "laser: " + sick_.last_error();
  }
  if (nod_.is_stalled()) {
    return "servo: does not move when commanded to";
  }
  if (is_blind(now)) {
    return "laser: blind (no readings)";
  }
  if (now - last_scan_ > std::max(kShortestNoScan, sick_.stream_timeout())) {
    return "no scan could be given a pitch";
  }
  return "";
}

std::string Laser3d::shortcoming() const {
  constexpr double kUnmeasuredRatio = 0.1;
  constexpr int kErrorSeverity = 3;
  if (const std::string warning = servo_->warning(); !warning.empty()) {
    return "servo: " + warning;
  }
  if (status_.severity() >= kErrorSeverity) {
    return "laser: reports an error";
  }
  if (status_.implausible()) {
    return "laser: calls its own readings implausible";
  }
  if (status_.polluted()) {
    return "laser: the front window is dirty";
  }
  if (const time::FineDuration delay = mirror_sync_.delay(); delay > 0us) {
    return "laser: " + describe_delay(delay);
  }
  // The lines of a sweep are then farther apart than the pitch controller has computed.
  if (telegram_loss_.loses_many()) {
    return "laser: many scans are lost: check its line";
  }
  if (pitch_loss_.loses_many()) {
    return "servo: many scans are without a pitch: check its line";
  }
  if (dazzled_ratio_ > kUnmeasuredRatio) {
    return "laser: dazzled";
  }
  return unmeasured_ratio_ > kUnmeasuredRatio ? "laser: many beams are not measured" : "";
}

}  // namespace nodmap::laser3d
