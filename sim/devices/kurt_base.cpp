// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/kurt_base.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {
namespace {

// Identifiers of the frames.
constexpr std::uint16_t kControl = 0x001;
constexpr std::uint16_t kAdc0To3 = 0x005;
constexpr std::uint16_t kAdc4To7 = 0x006;
constexpr std::uint16_t kAdc8To11 = 0x007;
constexpr std::uint16_t kAdc12To15 = 0x008;
constexpr std::uint16_t kEncoder = 0x009;
constexpr std::uint16_t kSpeed = 0x00C;
constexpr std::uint16_t kTilt = 0x00D;
constexpr std::uint16_t kGyro = 0x00E;

// Modes of CONTROL.
constexpr int kModeRaw = 0;
constexpr int kModeSpeed = 1;
constexpr int kModeSpeedCm = 2;
constexpr int kModeGyroReset = 0xFF03;
constexpr int kModeReset = 0xFFFF;

constexpr time::FineDuration kHalfPeriod = 5ms;
constexpr double kPeriodS = 0.01;
constexpr time::Duration kCommandTimeout = 100ms;
constexpr time::Duration kResetTime = 200ms;

constexpr double kTopSpeedMps = 5.2;
constexpr int kFullPwm = 1023;
constexpr std::int64_t kMaxTicks = std::numeric_limits<std::int16_t>::max();  // in a frame

// The infrared range finders (Sharp GP2D12): beams without width or noise. Beyond their range they
// read kInfraredFar. How high they are mounted is not documented.
constexpr int kInfraredFar = 60;
constexpr double kInfraredReachM = 0.8;
constexpr double kInfraredHeightM = 0.12;
// The sonar is not modelled; it always reads "nothing in range".
constexpr int kSonarFar = 1100;

constexpr double kTiltZero = 32'768.0;
constexpr double kTiltPerG = 3932.0;
constexpr double kGravityMps2 = 9.81;
constexpr double kGyroPerDegree = 4'992'511.0;
constexpr double kIdleMilliampere = 200.0;
constexpr double kMilliamperePerMps = 800.0;
constexpr int kBoardTemperature = 35;

int u16(const CanFrame& frame, std::size_t at) {
  return frame.data[at] << 8 | frame.data[at + 1];
}

int i16(const CanFrame& frame, std::size_t at) {
  return static_cast<std::int16_t>(u16(frame, at));
}

CanFrame frame_of(std::uint16_t id, const std::array<std::int64_t, 4>& words) {
  CanFrame frame;
  frame.id = id;
  for (std::size_t i = 0; i < words.size(); ++i) {
    frame.data[2 * i] = static_cast<std::uint8_t>(words[i] >> 8 & 0xFF);
    frame.data[2 * i + 1] = static_cast<std::uint8_t>(words[i] & 0xFF);
  }
  return frame;
}

// A frame of two 4-byte numbers.
CanFrame frame_of(std::uint16_t id, std::int64_t first, std::int64_t second) {
  return frame_of(id, {first >> 16, first, second >> 16, second});
}

std::int64_t tilt_word(double sine) {
  return std::llround(kTiltZero + kTiltPerG * sine);
}

}  // namespace

KurtBase::KurtBase(const KurtBaseParams& params, RobotModel& model, time::SteadyTime power_on,
                   std::uint64_t seed)
    : params_(params),
      model_(model),
      start_(power_on),
      last_command_(power_on),
      gyro_(params.gyro, model.ground_truth().T_world_base.linear(), model.now(), seed) {}

time::SteadyTime KurtBase::frame_due() const {
  const time::FineDuration slot = kHalfPeriod * (1.0 + 1e-6 * params_.clock_ppm);
  return start_ + time::rounded(static_cast<double>(slot_) * slot);
}

time::SteadyTime KurtBase::next_due() const {
  return std::min(frame_due(), has_timed_out_ ? kNever : last_command_ + kCommandTimeout);
}

CanFrame KurtBase::next_frame() {
  const std::int64_t slot = slot_++;
  return slot % 2 == 0 ? encoder_frame() : sensor_frame(slot / 2);
}

void KurtBase::check_command_timeout(time::SteadyTime now) {
  if (!has_timed_out_ && now >= last_command_ + kCommandTimeout) {
    has_timed_out_ = true;
    model_.set_wheel_speeds({});
  }
}

void KurtBase::receive(const CanFrame& frame, time::SteadyTime now) {
  if (frame.id != kControl || frame.length != 8) {
    return;
  }
  last_command_ = now;
  has_timed_out_ = false;
  if (u16(frame, 0) == kModeReset) {
    reset(now);
  } else {
    control(frame);
  }
}

void KurtBase::control(const CanFrame& frame) {
  switch (u16(frame, 0)) {
    case kModeRaw:
      control_raw(frame);
      break;
    case kModeSpeed: {  // ticks per period
      const double mps = params_.wheel_perimeter_m / params_.ticks_per_revolution / kPeriodS;
      model_.set_wheel_speeds({mps * i16(frame, 2), mps * i16(frame, 4)});
      break;
    }
    case kModeSpeedCm:
      model_.set_wheel_speeds({0.01 * i16(frame, 2), 0.01 * i16(frame, 4)});
      break;
    case kModeGyroReset:
      gyro_.reset();
      break;
    default:
      break;
  }
}

// Per side: direction and brake bits, then the inverted duty cycle, taken as a fraction of the top
// speed.
void KurtBase::control_raw(const CanFrame& frame) {
  constexpr unsigned kBrakeBit = 1;
  constexpr unsigned kBackBit = 2;
  const auto speed_mps = [&frame](std::size_t at) {
    const unsigned bits = frame.data[at];
    const double duty =
        1.0 - std::min(u16(frame, at + 1), kFullPwm) / static_cast<double>(kFullPwm);
    const double speed = (bits & kBrakeBit) != 0 ? 0.0 : duty * kTopSpeedMps;
    return (bits & kBackBit) != 0 ? -speed : speed;
  };
  constexpr std::size_t kLeftAt = 2;
  constexpr std::size_t kRightAt = 5;
  if ((frame.data[kLeftAt] & frame.data[kRightAt] & kBrakeBit) != 0) {
    model_.brake_wheels();
  } else {
    model_.set_wheel_speeds({speed_mps(kLeftAt), speed_mps(kRightAt)});
  }
}

// Switches the motors off; no frames until it has restarted.
void KurtBase::reset(time::SteadyTime now) {
  model_.set_wheel_speeds({});
  has_timed_out_ = true;
  start_ = now + kResetTime;
  slot_ = 1;
  left_reported_ = ticks(model_.wheel_travel().left_m);
  right_reported_ = ticks(model_.wheel_travel().right_m);
  gyro_.reset();
}

std::int64_t KurtBase::ticks(double distance_m) const {
  return static_cast<std::int64_t>(
      std::floor(distance_m / params_.wheel_perimeter_m * params_.ticks_per_revolution));
}

// Whole ticks since the last frame; fractions are carried over.
CanFrame KurtBase::encoder_frame() {
  const auto delta = [](std::int64_t total, std::int64_t& reported) {
    const std::int64_t ticks = std::clamp(total - reported, -kMaxTicks, kMaxTicks);
    reported += ticks;
    return ticks;
  };
  const WheelTravel& travel = model_.wheel_travel();
  return frame_of(kEncoder, {delta(ticks(travel.left_m), left_reported_),
                             delta(ticks(travel.right_m), right_reported_), 0, 0});
}

// The inverse of the formula in the base's software: cm = (30000 / (raw - 10))^(1 / 1.4) - 10.
std::int64_t KurtBase::infrared_reading(robot::Infrared sensor) const {
  if (!params_.has_infrared) {
    return kInfraredFar;
  }
  const geometry::SE2& mount = robot::mount_of(sensor);
  const auto range_m =
      model_.distance_from({mount.x, mount.y, kInfraredHeightM}, mount.yaw, kInfraredReachM);
  return range_m ? std::llround(10.0 + 30'000.0 / std::pow(100.0 * *range_m + 10.0, 1.4))
                 : kInfraredFar;
}

CanFrame KurtBase::sensor_frame(std::int64_t period) {
  constexpr std::array kSenses = {kAdc0To3, kAdc4To7, kAdc8To11, kAdc12To15, kSpeed, kTilt, kGyro};
  const GroundTruth truth = model_.ground_truth();
  const Eigen::Matrix3d rotation = truth.T_world_base.linear();
  // Gravity along the robot's axes: left side up is a roll to the right, front up a pitch.
  const double felt = params_.tilt_feels_acceleration ? 1.0 / kGravityMps2 : 0.0;
  const std::int64_t roll = tilt_word(rotation(2, 1) + felt * truth.acceleration_mps2.y());
  const std::int64_t pitch = tilt_word(rotation(2, 0) + felt * truth.acceleration_mps2.x());
  using robot::Infrared;
  const std::uint16_t kind = kSenses[static_cast<std::size_t>(period) % kSenses.size()];
  switch (kind) {
    case kAdc0To3:
      return frame_of(kind,
                      {infrared_reading(Infrared::kBack), infrared_reading(Infrared::kRightBack),
                       infrared_reading(Infrared::kRight), 0});
    case kAdc4To7:
      return frame_of(kind,
                      {infrared_reading(Infrared::kRightFront), kSonarFar,
                       infrared_reading(Infrared::kLeftFront), infrared_reading(Infrared::kLeft)});
    case kAdc8To11:
      return frame_of(kind, {0, infrared_reading(Infrared::kLeftBack), roll, pitch});
    case kAdc12To15: {
      const WheelSpeeds speeds = model_.wheel_speeds();
      const auto current = [](double speed_mps) {
        return std::llround(kIdleMilliampere + kMilliamperePerMps * std::abs(speed_mps));
      };
      return frame_of(kind,
                      {current(speeds.right_mps), current(speeds.left_mps), 0, kBoardTemperature});
    }
    case kSpeed:
      return frame_of(kind, left_reported_, right_reported_);
    case kTilt:
      return frame_of(kind, {roll, pitch, 0, 0});
    default:
      return frame_of(
          kGyro,
          std::llround(kGyroPerDegree * geometry::rad_to_deg(gyro_.read(rotation, model_.now()))),
          0);
  }
}

SlcanKurtBase::SlcanKurtBase(const SlcanKurtParams& params, RobotModel& model,
                             time::SteadyTime power_on, std::uint64_t seed)
    : baud_(params.baud),
      base_(params.base, model, power_on, seed),
      now_(power_on),
      adapter_([this](const CanFrame& frame) { base_.receive(frame, now_); }) {}

void SlcanKurtBase::receive(ByteView bytes, int baud, time::SteadyTime now) {
  now_ = now;
  for (const std::uint8_t byte : received_bytes(baud_, bytes, baud)) {
    send(adapter_.take(static_cast<char>(byte)), now);
  }
}

void SlcanKurtBase::transmit(time::SteadyTime now, int baud, Bytes& line) {
  base_.check_command_timeout(now);
  while (base_.frame_due() <= now) {
    const time::SteadyTime sent = base_.frame_due();
    send(adapter_.from_bus(base_.next_frame(), sent), sent);
  }
  output_.take(now, baud, line);
}

time::SteadyTime SlcanKurtBase::next_due() const {
  return std::min(base_.next_due(), output_.next_due());
}

void SlcanKurtBase::send(const std::string& text, time::SteadyTime from) {
  output_.send({text.begin(), text.end()}, baud_, from);
}

}  // namespace nodmap::sim
