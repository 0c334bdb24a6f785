// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/laser3d.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/laser3d/dynamixel_session.hpp"
#include "drivers/laser3d/maestro_session.hpp"

namespace nodmap::laser3d {
namespace {

// A laser that nods meets the floor, or what stands on it, in every nod; one that meets nothing is
// blind, and its world only looks free. What appears just behind the beam may go unseen for a nod
// anyway, and the robot keeps the way that needs: blind for so long, it is as safe as ever. Never
// shorter than a second, for a fast nod may miss a reading or two.
constexpr std::int64_t kShortestBlindUs = 1'000'000;
// Two sweeps of 500 scans, the slowest a pitch controller asks for (6.7 s each), and a reserve. A
// head that nods more slowly yet may look at the open sky for longer: then the robot stands.
constexpr std::int64_t kLongestBlindUs = 15'000'000;
constexpr double kNodReserve = 1.1;
// Fewer readings may be specks of dust or the laser's own noise.
constexpr int kFewestReadings = 10;

std::int64_t microseconds(double duration_s) {
  return std::llround(1e6 * duration_s);
}

SickSettings sick_settings(const Laser3dParams& params) {
  SickSettings settings;
  settings.baud = params.laser_baud;
  settings.variant = params.variant;
  settings.interlaced = params.interlaced;
  settings.unit = params.unit;
  settings.frozen_scans = params.frozen_scans;
  switch (params.reach) {
    case LaserReach::k8m:
      settings.measuring_mode = {0x02};
      break;
    case LaserReach::k16m:
      settings.measuring_mode = {0x04};
      break;
    case LaserReach::k32m:
      settings.measuring_mode = {0x06};
      break;
  }
  return settings;
}

std::unique_ptr<ServoSession> make_servo(const Laser3dParams& params) {
  const auto period_us = microseconds(1.0 / params.servo_poll_hz);
  if (params.servo == ServoKind::kMaestro) {
    MaestroSettings settings;
    settings.channel = params.servo_id;
    settings.level_pulse_us = params.maestro_level_us;
    settings.pulse_us_per_rad = geometry::rad_to_deg(params.maestro_us_per_deg);
    settings.period_us = period_us;
    return std::make_unique<MaestroSession>(settings);
  }
  DynamixelSettings settings;
  settings.id = static_cast<std::uint8_t>(params.servo_id);
  settings.baud = params.servo_baud;
  settings.level_position = params.servo_level_position;
  settings.inverted = params.servo_inverted;
  settings.acceleration_rad_s2 = params.robot.head.pitch_acceleration_rad_s2;
  settings.period_us = period_us;
  return std::make_unique<DynamixelSession>(settings);
}

NodSettings nod_settings(const Laser3dParams& params) {
  NodSettings settings;
  settings.fallback = {params.default_min_rad, params.default_max_rad, params.default_sweep_s};
  settings.min_rad = params.robot.head.pitch_min_rad;
  settings.max_rad = params.robot.head.pitch_max_rad;
  settings.max_speed_rad_s = params.robot.head.pitch_rate_rad_s;
  settings.acceleration_rad_s2 = params.robot.head.pitch_acceleration_rad_s2;
  settings.command_timeout_us = microseconds(params.command_timeout_s);
  return settings;
}

JoinerSettings joiner_settings(const Laser3dParams& params) {
  JoinerSettings settings;
  settings.max_extrapolation_us = microseconds(params.max_extrapolation_s);
  return settings;
}

}  // namespace

Laser3d::Laser3d(const Laser3dParams& params)
    : params_(params),
      sick_(sick_settings(params)),
      // The motor is told to turn at 75 Hz, and the manual rounds its period: hence the bound.
      mirror_sync_({.tick_us = kMirrorTurnUs, .wrap_ticks = 256, .max_drift = 0.002}),
      servo_(make_servo(params)),
      nod_(nod_settings(params)),
      joiner_(joiner_settings(params)),
      T_base_mount_(Eigen::Translation3d(params.robot.mount.x_m, params.robot.mount.y_m,
                                         params.robot.mount.z_m)) {}

Laser3dOutput Laser3d::laser_opened(std::int64_t now_us) {
  Laser3dOutput result;
  take(sick_.open(now_us), result);
  return result;
}

Laser3dOutput Laser3d::servo_opened(std::int64_t now_us) {
  Laser3dOutput result;
  take(servo_->open(now_us), now_us, result);
  return result;
}

void Laser3d::laser_lost() {
  sick_.close();
}

void Laser3d::servo_lost() {
  servo_->close();
  joiner_.forget_pitch();
}

Laser3dOutput Laser3d::receive_laser(ByteView bytes, std::int64_t now_us) {
  Laser3dOutput result;
  parser_.feed(bytes, now_us);
  while (const auto event = parser_.next()) {
    if (const auto* telegram = std::get_if<SickTelegram>(&*event)) {
      take(sick_.take(*telegram, now_us), result);
    } else if (std::holds_alternative<SickNak>(*event)) {
      sick_.take_nak(now_us);
    }
  }
  join(now_us, result);
  return result;
}

Laser3dOutput Laser3d::receive_servo(ByteView bytes, std::int64_t now_us) {
  Laser3dOutput result;
  take(servo_->receive(bytes, now_us), now_us, result);
  join(now_us, result);
  return result;
}

Laser3dOutput Laser3d::poll(std::int64_t now_us) {
  parser_.expire(now_us);
  Laser3dOutput result = receive_laser({}, now_us);
  take(sick_.poll(now_us), result);
  take(servo_->poll(now_us), now_us, result);
  if (!servo_->running()) {
    joiner_.forget_pitch();
  }
  return result;
}

bool Laser3d::command(const AreaOfInterest& area, std::int64_t now_us) {
  return nod_.command(area, now_us);
}

Laser3dOutput Laser3d::shut_down(std::int64_t now_us) {
  Laser3dOutput result;
  take(sick_.shut_down(now_us), result);
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

void Laser3d::take(ServoOutput output, std::int64_t now_us, Laser3dOutput& result) {
  if (!output.send.empty()) {
    result.servo.push_back({std::nullopt, std::move(output.send)});
  }
  if (output.sample) {
    joiner_.add(*output.sample);
    const Nod::Aim aim = nod_.step(*output.sample, now_us);
    servo_->aim(aim.goal_rad, aim.speed_rad_s);
    result.pitch.push_back(
        {*output.sample, aim, nod_.sweep(), servo_->measures_pitch(), nod_.stalled()});
  }
}

void Laser3d::take_scan(const SickScan& scan) {
  counts_.dazzled_beams += scan.num_dazzled;
  const double beams = std::max(1.0, static_cast<double>(scan.ranges_m.size()));
  dazzled_share_ = scan.num_dazzled / beams;
  unmeasured_share_ = (scan.num_dazzled + scan.num_unmeasured) / beams;
  status_ = scan.status;
  if (sees_something(scan)) {
    last_sight_us_ = scan.first_byte_us;
  }
  const std::int64_t sent = sent_us(scan) + microseconds(params_.laser_time_offset_s);
  if (params_.interlaced) {
    joiner_.add(interlaced_turn(scan, sent));
    return;
  }
  for (MirrorTurn& turn : mirror_turns(scan, params_.variant, sent)) {
    joiner_.add(std::move(turn));
  }
}

bool Laser3d::sees_something(const SickScan& scan) const {
  // A covered window gives readings, too: of no distance.
  const auto counts = [this](double range_m) {
    return range_m >= params_.range_min_m && range_m <= params_.range_max_m;
  };
  const auto readings = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(), counts);
  return readings >= kFewestReadings;
}

bool Laser3d::is_blind(std::int64_t now_us) const {
  const auto nod_us =
      static_cast<std::int64_t>(kNodReserve * static_cast<double>(nod_.nod_us(now_us)));
  return !last_sight_us_ ||
         now_us - *last_sight_us_ > std::clamp(nod_us, kShortestBlindUs, kLongestBlindUs);
}

std::int64_t Laser3d::sent_us(const SickScan& scan) {
  if (!scan.indices) {
    return scan.first_byte_us;
  }
  if (last_telegram_index_ && connections_ == sick_.counts().connections) {
    counts_.telegrams_missed +=
        static_cast<std::uint8_t>(scan.indices->telegram - *last_telegram_index_ - 1);
  }
  last_telegram_index_ = scan.indices->telegram;
  connections_ = sick_.counts().connections;
  return mirror_sync_.to_host_us(scan.indices->scan, scan.first_byte_us);
}

void Laser3d::join(std::int64_t now_us, Laser3dOutput& result) {
  while (std::optional<PitchedTurn> pitched = joiner_.next(now_us)) {
    last_scan_us_ = now_us;
    if (is_blind(now_us)) {
      ++counts_.scans_blind;
      continue;
    }
    ++counts_.scans;
    result.scans.push_back(to_scan(std::move(*pitched)));
  }
  if (counts_.scans == 0) {
    dropped_at_start_ = joiner_.dropped();  // the laser was there before the servo
  }
  counts_.scans_without_pitch = joiner_.dropped() - dropped_at_start_;
}

scan::Scan Laser3d::to_scan(PitchedTurn pitched) {
  scan::Scan scan;
  scan.utime_us = pitched.turn.first_beam_us;
  scan.duration_us = pitched.turn.last_beam_us - pitched.turn.first_beam_us;
  scan.seq = scan_seq_++;
  const double sign = params_.upside_down ? -1.0 : 1.0;
  scan.angle_first_rad = sign * pitched.turn.angle_first_rad;
  scan.angle_step_rad = sign * pitched.turn.angle_step_rad;
  scan.pitch_first_rad = pitched.pitch_first_rad;
  scan.pitch_last_rad = pitched.pitch_last_rad;
  scan.pitch_measured = servo_->measures_pitch();
  scan.range_min_m = params_.range_min_m;
  scan.range_max_m = std::min(params_.range_max_m, pitched.turn.range_max_m);
  scan.T_base_mount = T_base_mount_;
  scan.mirror_offset_m = {params_.mirror_forward_m, 0.0, params_.mirror_up_m};
  scan.ranges_m = std::move(pitched.turn.ranges_m);
  return scan;
}

Judgement Laser3d::judge(std::int64_t now_us) const {
  constexpr std::int64_t kNoScanUs = 500'000;
  constexpr double kUnmeasuredShare = 0.1;
  constexpr int kErrorSeverity = 3;
  if (!servo_->running()) {
    return {Condition::kFailed, "servo: " + servo_->trouble()};
  }
  if (!sick_.trouble().empty()) {
    return {Condition::kFailed, "laser: " + sick_.trouble()};
  }
  if (nod_.stalled()) {
    return {Condition::kFailed, "servo: it is told to move and does not"};
  }
  if (is_blind(now_us)) {
    return {Condition::kFailed, "laser: it sees nothing"};
  }
  if (now_us - last_scan_us_ > kNoScanUs) {
    return {Condition::kFailed, "no scan could be given a pitch"};
  }
  if (status_.severity() >= kErrorSeverity) {
    return {Condition::kDegraded, "laser: it reports an error of its own"};
  }
  if (status_.polluted()) {
    return {Condition::kDegraded, "laser: the front window is dirty"};
  }
  if (dazzled_share_ > kUnmeasuredShare) {
    return {Condition::kDegraded, "laser: dazzled"};
  }
  if (unmeasured_share_ > kUnmeasuredShare) {
    return {Condition::kDegraded, "laser: many beams are not measured"};
  }
  return {};
}

}  // namespace nodmap::laser3d
