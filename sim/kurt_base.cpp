// SPDX-License-Identifier: BSD-3-Clause
#include "sim/kurt_base.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"
#include "sim/bytes.hpp"

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

constexpr double kHalfPeriodUs = 5000.0;
constexpr double kPeriodS = 0.01;
constexpr std::int64_t kDropOutUs = 100'000;
constexpr std::int64_t kResetUs = 200'000;

constexpr double kTopSpeedMps = 5.2;
constexpr int kFullPwm = 1023;
constexpr std::int64_t kMostTicks = std::numeric_limits<std::int16_t>::max();  // in a frame

// Readings of the range finders with nothing in sight: the plant has no beam for them.
constexpr int kInfraredFar = 60;
constexpr int kSonarFar = 1100;

constexpr double kTiltZero = 32'768.0;
constexpr double kTiltPerG = 3932.0;
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

/// Two numbers of four bytes.
CanFrame frame_of(std::uint16_t id, std::int64_t first, std::int64_t second) {
  return frame_of(id, {first >> 16, first, second >> 16, second});
}

std::int64_t tilt_word(double sine) {
  return std::llround(kTiltZero + kTiltPerG * sine);
}

double yaw_of(const Truth& truth) {
  const Eigen::Vector3d ahead = truth.T_world_base.linear().col(0);
  return std::atan2(ahead.y(), ahead.x());
}

}  // namespace

KurtBase::KurtBase(const KurtBaseSettings& settings, Plant& plant, std::int64_t power_on_us)
    : settings_(settings),
      plant_(plant),
      start_us_(power_on_us),
      heard_us_(power_on_us),
      gyro_zero_rad_(yaw_of(plant.truth())) {}

std::int64_t KurtBase::next_frame_us() const {
  const double slot_us = kHalfPeriodUs * (1.0 + 1e-6 * settings_.clock_ppm);
  return start_us_ + std::llround(static_cast<double>(slot_) * slot_us);
}

std::int64_t KurtBase::next_us() const {
  return std::min(next_frame_us(), dropped_out_ ? kNever : heard_us_ + kDropOutUs);
}

CanFrame KurtBase::next_frame() {
  const std::int64_t slot = slot_++;
  return slot % 2 == 0 ? encoder_frame() : sensor_frame(slot / 2);
}

void KurtBase::watch_host(std::int64_t now_us) {
  if (!dropped_out_ && now_us >= heard_us_ + kDropOutUs) {
    dropped_out_ = true;
    plant_.set_wheel_speeds({});
  }
}

void KurtBase::receive(const CanFrame& frame, std::int64_t now_us) {
  if (frame.id != kControl || frame.length != 8) {
    return;
  }
  heard_us_ = now_us;
  dropped_out_ = false;
  if (u16(frame, 0) == kModeReset) {
    reset(now_us);
  } else {
    control(frame);
  }
}

void KurtBase::control(const CanFrame& frame) {
  switch (u16(frame, 0)) {
    case kModeRaw:
      control_raw(frame);
      break;
    case kModeSpeed: {  // ticks in a period
      const double mps = settings_.wheel_perimeter_m / settings_.ticks_per_turn / kPeriodS;
      plant_.set_wheel_speeds({mps * i16(frame, 2), mps * i16(frame, 4)});
      break;
    }
    case kModeSpeedCm:
      plant_.set_wheel_speeds({0.01 * i16(frame, 2), 0.01 * i16(frame, 4)});
      break;
    case kModeGyroReset:
      gyro_zero_rad_ = yaw_of(plant_.truth());
      break;
    default:
      break;
  }
}

/// Per side: direction and brake bits, then the duty cycle, inverted. The duty stands for a share
/// of the top speed.
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
    plant_.brake_wheels();
  } else {
    plant_.set_wheel_speeds({speed_mps(kLeftAt), speed_mps(kRightAt)});
  }
}

/// Motors off, and silence until it has started again.
void KurtBase::reset(std::int64_t now_us) {
  plant_.set_wheel_speeds({});
  dropped_out_ = true;
  start_us_ = now_us + kResetUs;
  slot_ = 1;
  left_told_ = ticks(plant_.wheel_travel().left_m);
  right_told_ = ticks(plant_.wheel_travel().right_m);
  gyro_zero_rad_ = yaw_of(plant_.truth());
}

std::int64_t KurtBase::ticks(double way_m) const {
  return static_cast<std::int64_t>(
      std::floor(way_m / settings_.wheel_perimeter_m * settings_.ticks_per_turn));
}

/// Whole ticks since the last frame; parts of a tick are told when they have become whole.
CanFrame KurtBase::encoder_frame() {
  const auto delta = [](std::int64_t total, std::int64_t& told) {
    const std::int64_t ticks = std::clamp(total - told, -kMostTicks, kMostTicks);
    told += ticks;
    return ticks;
  };
  const WheelTravel& travel = plant_.wheel_travel();
  return frame_of(kEncoder, {delta(ticks(travel.left_m), left_told_),
                             delta(ticks(travel.right_m), right_told_), 0, 0});
}

CanFrame KurtBase::sensor_frame(std::int64_t period) const {
  constexpr std::array kKinds = {kAdc0To3, kAdc4To7, kAdc8To11, kAdc12To15, kSpeed, kTilt, kGyro};
  const Truth truth = plant_.truth();
  const Eigen::Matrix3d rotation = truth.T_world_base.linear();
  // What gravity does along the robot's axes: left side up is a roll to the right, front up a
  // pitch.
  const std::int64_t roll = tilt_word(rotation(2, 1));
  const std::int64_t pitch = tilt_word(rotation(2, 0));
  const std::uint16_t kind = kKinds[static_cast<std::size_t>(period) % kKinds.size()];
  switch (kind) {
    case kAdc0To3:
      return frame_of(kind, {kInfraredFar, kInfraredFar, kInfraredFar, 0});
    case kAdc4To7:
      return frame_of(kind, {kInfraredFar, kSonarFar, kInfraredFar, kInfraredFar});
    case kAdc8To11:
      return frame_of(kind, {0, kInfraredFar, roll, pitch});
    case kAdc12To15: {
      const WheelSpeeds speeds = plant_.wheel_speeds();
      const auto current = [](double speed_mps) {
        return std::llround(kIdleMilliampere + kMilliamperePerMps * std::abs(speed_mps));
      };
      return frame_of(kind,
                      {current(speeds.right_mps), current(speeds.left_mps), 0, kBoardTemperature});
    }
    case kSpeed:
      return frame_of(kind, left_told_, right_told_);
    case kTilt:
      return frame_of(kind, {roll, pitch, 0, 0});
    default: {
      const double yaw_deg =
          geometry::rad_to_deg(geometry::angle_difference(yaw_of(truth), gyro_zero_rad_));
      return frame_of(kGyro, std::llround(kGyroPerDegree * yaw_deg), 0);
    }
  }
}

}  // namespace nodmap::sim
