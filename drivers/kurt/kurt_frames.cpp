// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/kurt_frames.hpp"

#include <algorithm>
#include <boost/endian/conversion.hpp>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace {

using boost::endian::load_big_s16;
using boost::endian::load_big_s32;
using boost::endian::load_big_u16;

constexpr std::uint32_t kControlId = 0x001;
constexpr std::uint32_t kAdc0To3Id = 0x005;
constexpr std::uint32_t kAdc4To7Id = 0x006;
constexpr std::uint32_t kAdc8To11Id = 0x007;
constexpr std::uint32_t kAdc12To15Id = 0x008;
constexpr std::uint32_t kEncoderId = 0x009;
constexpr std::uint32_t kBumperId = 0x00A;
constexpr std::uint32_t kTiltId = 0x00D;
constexpr std::uint32_t kGyroId = 0x00E;

constexpr std::uint8_t kModeRaw = 0;
constexpr std::uint8_t kModeSpeedCm = 2;
// Without this bit the base's controller fails on a step from zero to full speed.
constexpr std::uint8_t kAntiWindup = 1;

// Speed in cm/s; 0 for NaN.
std::int16_t to_cm_per_s(double speed_mps) {
  if (!std::isfinite(speed_mps)) {
    return 0;
  }
  constexpr double kLargest = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::clamp(std::round(100.0 * speed_mps), -kLargest, kLargest));
}

std::optional<int>& of(RangeReadings& readings, Infrared sensor) {
  return readings.infrared_raw[static_cast<std::size_t>(sensor)];
}

RangeReadings decode_adc0_to_3(const CanFrame& frame) {
  RangeReadings readings;
  of(readings, Infrared::kBack) = load_big_u16(frame.data.data());
  of(readings, Infrared::kRightBack) = load_big_u16(&frame.data[2]);
  of(readings, Infrared::kRight) = load_big_u16(&frame.data[4]);
  return readings;
}

RangeReadings decode_adc4_to_7(const CanFrame& frame) {
  RangeReadings readings;
  of(readings, Infrared::kRightFront) = load_big_u16(frame.data.data());
  readings.sonar_raw = load_big_u16(&frame.data[2]);
  of(readings, Infrared::kLeftFront) = load_big_u16(&frame.data[4]);
  of(readings, Infrared::kLeft) = load_big_u16(&frame.data[6]);
  return readings;
}

RangeReadings decode_adc8_to_11(const CanFrame& frame) {
  RangeReadings readings;
  of(readings, Infrared::kLeftBack) = load_big_u16(&frame.data[2]);
  return readings;
}

// The tilt angle: its sine is the measured acceleration in g, limited to 1 because vibration
// exceeds 1 g.
double tilt_rad(std::uint16_t raw) {
  return std::asin(std::clamp((raw - 32768.0) / 3932.0, -1.0, 1.0));
}

Gyro decode_gyro(const CanFrame& frame) {
  const double to_rad = geometry::deg_to_rad(1.0);
  return {load_big_s32(frame.data.data()) / 4992511.0 * to_rad,
          load_big_s32(&frame.data[4]) / 10000.0 * to_rad * to_rad};
}

// The encoders need half of the frame's bytes, the bumpers one; every other kind needs all of
// them.
std::size_t bytes_needed(std::uint32_t id) {
  if (id == kBumperId) {
    return 1;
  }
  return id == kEncoderId ? 4 : 8;
}

Report decode_full(const CanFrame& frame) {
  switch (frame.id) {
    case kAdc0To3Id:
      return decode_adc0_to_3(frame);
    case kAdc4To7Id:
      return decode_adc4_to_7(frame);
    case kAdc8To11Id:
      return decode_adc8_to_11(frame);
    case kAdc12To15Id:
      return MotorCurrents{1e-3 * load_big_u16(&frame.data[2]),
                           1e-3 * load_big_u16(frame.data.data())};  // right comes first, in mA
    case kEncoderId:
      return EncoderTicks{load_big_s16(frame.data.data()), load_big_s16(&frame.data[2])};
    case kBumperId:
      return Bumpers{frame.data[0] != 0};
    case kTiltId:
      return Tilt{tilt_rad(load_big_u16(frame.data.data())),
                  tilt_rad(load_big_u16(&frame.data[2]))};
    case kGyroId:
      return decode_gyro(frame);
    default:
      return std::monostate{};
  }
}

}  // namespace

CanFrame speed_command(const WheelSpeeds& speeds) {
  CanFrame frame;
  frame.id = kControlId;
  frame.length = 8;
  frame.data[1] = kModeSpeedCm;
  boost::endian::store_big_s16(&frame.data[2], to_cm_per_s(speeds.left_mps));
  boost::endian::store_big_s16(&frame.data[4], to_cm_per_s(speeds.right_mps));
  // Byte 6 and the rest of byte 7 are the yaw rate for the base's own gyro control: zero, unused.
  frame.data[7] = kAntiWindup;
  return frame;
}

CanFrame hard_stop() {
  // Per wheel: direction and brake bits, then the inverted duty cycle: 1023 means motor off.
  constexpr std::uint8_t kForwardBraked = 1;
  CanFrame frame;
  frame.id = kControlId;
  frame.length = 8;
  frame.data = {0, kModeRaw, kForwardBraked, 0x03, 0xFF, kForwardBraked, 0x03, 0xFF};
  return frame;
}

Report decode(const CanFrame& frame) {
  if (frame.extended || frame.remote || frame.length < bytes_needed(frame.id)) {
    return std::monostate{};
  }
  return decode_full(frame);
}

std::optional<double> infrared_range_m(int raw) {
  if (raw > 800) {
    return 0.0;
  }
  if (raw < 100) {
    return std::nullopt;
  }
  return 0.01 * (std::pow(30000.0 / (raw - 10.0), 1.0 / 1.4) - 10.0);
}

std::optional<double> sonar_range_m(int raw) {
  if (raw < 100 || raw > 1000) {
    return std::nullopt;
  }
  return 0.01 * (0.110652 * raw + 11.9231);
}

}  // namespace nodmap::kurt
