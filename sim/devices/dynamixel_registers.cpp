// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/dynamixel_registers.hpp"

#include <algorithm>

namespace nodmap::sim {
namespace {

using namespace dynamixel_register;  // NOLINT(google-build-using-namespace): the register names

constexpr std::uint16_t kMemoryEnd = 64;

struct Register {
  std::uint16_t address;
  std::uint8_t size;
  bool is_writable;
  std::int64_t min;
  std::int64_t max;
  std::int32_t initial;
};

constexpr std::int64_t kAny = std::int64_t{1} << 31;

constexpr std::array kRegisters = {
    Register{kModel, 2, false, 0, 0, 1020},
    Register{2, 4, false, 0, 0, 0},  // model information
    Register{kFirmware, 1, false, 0, 0, 0x26},
    Register{kId, 1, true, 0, 252, 1},
    Register{8, 1, true, 0, 7, 3},  // baud rate: 1 Mbit/s
    Register{kReturnDelay, 1, true, 0, 254, 250},
    Register{10, 1, true, 0, 13, 0},  // drive mode
    Register{kOperatingMode, 1, true, 0, 16, 3},
    Register{12, 1, true, 0, 255, 255},  // secondary id
    Register{13, 1, true, 1, 2, 2},      // protocol
    Register{20, 4, true, -1'044'479, 1'044'479, 0},
    Register{kMovingThreshold, 4, true, 0, 1023, 10},
    Register{31, 1, true, 0, 100, 80},    // temperature limit
    Register{32, 2, true, 95, 160, 160},  // voltage limits
    Register{34, 2, true, 95, 160, 95},
    Register{36, 2, true, 0, 885, 885},    // PWM limit
    Register{38, 2, true, 0, 2047, 2047},  // current limit
    Register{44, 4, true, 0, 1023, 1023},  // velocity limit
    Register{kMaxPosition, 4, true, 0, 4095, 4095},
    Register{kMinPosition, 4, true, 0, 4095, 0},
    Register{63, 1, true, 0, 255, 52},  // shutdown
    Register{kTorqueEnable, 1, true, 0, 1, 0},
    Register{65, 1, true, 0, 1, 0},  // LED
    Register{kStatusReturnLevel, 1, true, 0, 2, 2},
    Register{69, 1, false, 0, 0, 0},
    Register{kHardwareError, 1, false, 0, 0, 0},
    Register{76, 2, true, 0, 16'383, 1920},  // gains
    Register{78, 2, true, 0, 16'383, 100},
    Register{80, 2, true, 0, 16'383, 0},
    Register{82, 2, true, 0, 16'383, 0},
    Register{84, 2, true, 0, 16'383, 800},
    Register{88, 2, true, 0, 16'383, 0},
    Register{90, 2, true, 0, 16'383, 0},
    Register{kBusWatchdog, 1, true, 0, 127, 0},
    Register{kGoalPwm, 2, true, -885, 885, 885},
    Register{102, 2, true, -2047, 2047, 2047},  // goal current
    Register{104, 4, true, -1023, 1023, 0},     // goal velocity
    Register{kProfileAcceleration, 4, true, 0, 32'767, 0},
    Register{kProfileVelocity, 4, true, 0, 32'767, 0},
    Register{kGoalPosition, 4, true, -kAny, kAny, 2048},
    Register{kRealtimeTick, 2, false, 0, 0, 0},
    Register{kMoving, 1, false, 0, 0, 0},
    Register{123, 1, false, 0, 0, 0},  // moving status
    Register{124, 2, false, 0, 0, 0},  // PWM
    Register{126, 2, false, 0, 0, 0},  // current
    Register{kPresentVelocity, 4, false, 0, 0, 0},
    Register{kPresentPosition, 4, false, 0, 0, 2048},
    Register{kVelocityTrajectory, 4, false, 0, 0, 0},
    Register{kPositionTrajectory, 4, false, 0, 0, 2048},
    Register{kVoltage, 2, false, 0, 0, 120},
    Register{kTemperature, 1, false, 0, 0, 35},
};

const Register* find(std::size_t address) {
  const auto* found = std::ranges::find_if(
      kRegisters, [address](const Register& entry) { return entry.address == address; });
  return found == kRegisters.end() ? nullptr : found;
}

std::int32_t signed_number(ByteView bytes) {
  const std::uint32_t value = little_endian(bytes);
  return bytes.size() == 2 ? static_cast<std::int16_t>(value) : static_cast<std::int32_t>(value);
}

}  // namespace

DynamixelRegisters::DynamixelRegisters() {
  for (const Register& entry : kRegisters) {
    set(entry.address, entry.initial);
  }
}

void DynamixelRegisters::restart() {
  for (const Register& entry : kRegisters) {
    if (entry.address >= kMemoryEnd) {
      set(entry.address, entry.initial);
    }
  }
}

std::int32_t DynamixelRegisters::get(std::uint16_t address) const {
  const Register* entry = find(address);
  return entry == nullptr ? 0 : signed_number(ByteView(bytes_).subspan(address, entry->size));
}

void DynamixelRegisters::set(std::uint16_t address, std::int32_t value) {
  const Register* entry = find(address);
  for (std::size_t i = 0; entry != nullptr && i < entry->size; ++i) {
    bytes_[address + i] =
        static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (8 * i) & 0xFFU);
  }
}

DynamixelError DynamixelRegisters::check(std::uint16_t address, std::size_t size,
                                         std::int64_t value) const {
  const Register* entry = find(address);
  if (entry == nullptr || !entry->is_writable) {
    return DynamixelError::kAccess;
  }
  if (size < entry->size) {
    return DynamixelError::kLength;
  }
  if (address < kMemoryEnd && get(kTorqueEnable) != 0) {
    return DynamixelError::kAccess;
  }
  constexpr std::int32_t kPositionControl = 3;
  const bool bounded = address == kGoalPosition && get(kOperatingMode) == kPositionControl;
  const std::int64_t min = bounded ? get(kMinPosition) : entry->min;
  const std::int64_t max = bounded ? get(kMaxPosition) : entry->max;
  return value < min || value > max ? DynamixelError::kLimit : DynamixelError::kNone;
}

DynamixelError DynamixelRegisters::write(std::uint16_t address, ByteView values) {
  if (values.empty()) {
    return DynamixelError::kLength;
  }
  for (std::size_t done = 0; done < values.size();) {
    const auto at = static_cast<std::uint16_t>(address + done);
    const Register* entry = find(at);
    const std::size_t size = entry == nullptr ? 1 : entry->size;
    const ByteView part = values.subspan(done, std::min(size, values.size() - done));
    const DynamixelError error = check(at, part.size(), signed_number(part));
    if (error != DynamixelError::kNone) {
      return error;
    }
    done += size;
  }
  std::ranges::copy(values, bytes_.begin() + address);
  return DynamixelError::kNone;
}

DynamixelError DynamixelRegisters::read(std::uint16_t address, std::size_t count,
                                        Bytes& values) const {
  if (count == 0 || address + count > kSize) {
    return DynamixelError::kRange;
  }
  append(values, ByteView(bytes_).subspan(address, count));
  return DynamixelError::kNone;
}

}  // namespace nodmap::sim
