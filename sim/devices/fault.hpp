// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "common/formats/user_error.hpp"
#include "common/geometry/time.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

enum class Part : std::uint8_t { kLaser, kServo, kBase };

[[nodiscard]] std::string name_of(Part part);

enum class FaultKind : std::uint8_t {
  kDrop,     ///< bytes are lost, each with probability `amount`
  kCorrupt,  ///< one bit of a byte is flipped, in each with probability `amount`
  kDelay,    ///< the device's bytes arrive `amount` seconds late
  kUnplug,   ///< the port is gone
  kSilent,   ///< the device receives, but sends nothing
  kFreeze,   ///< the laser repeats its last measurement
  kStall,    ///< the servo's gear is blocked
};

[[nodiscard]] std::string name_of(FaultKind kind);

/// A temporary failure of a device or its line. Times are in seconds since the start of the
/// simulation.
struct Fault {
  Part part = Part::kLaser;
  FaultKind kind = FaultKind::kDrop;
  double from_s = 0.0;
  double duration_s = 0.0;
  double amount = 0.0;  ///< of drop, corrupt and delay

  [[nodiscard]] time::SteadyTime begin() const;
  [[nodiscard]] time::SteadyTime end() const;
  [[nodiscard]] bool is_active(time::SteadyTime now) const;
};

/// Thrown for an invalid description of a fault; what() is one line that says what is allowed.
class FaultError : public formats::UserError {
 public:
  using formats::UserError::UserError;
};

/// Parses "laser:unplug@10+2", "base:corrupt@5+10=0.01": part, kind, start, duration, amount.
/// Throws FaultError.
[[nodiscard]] Fault parse_fault(std::string_view text);

[[nodiscard]] bool is_any_active(FaultKind kind, const std::vector<Fault>& faults,
                                 time::SteadyTime now);

/// The faults of one part.
[[nodiscard]] std::vector<Fault> faults_of(Part part, const std::vector<Fault>& faults);

/// A device whose line has faults: drop, corrupt, delay, unplug, silent. The device itself is not
/// affected.
class FaultyDevice final : public SerialDevice {
 public:
  /// `device` must outlive this.
  FaultyDevice(SerialDevice& device, std::vector<Fault> faults, std::uint64_t seed);

  void receive(ByteView bytes, int baud, time::SteadyTime now) override;
  void transmit(time::SteadyTime now, int baud, Bytes& line) override;
  [[nodiscard]] time::SteadyTime next_due() const override;
  [[nodiscard]] bool is_plugged_in(time::SteadyTime now) const override;

 private:
  struct Delayed {
    time::SteadyTime due{};
    Bytes bytes;
  };

  [[nodiscard]] const Fault* active(FaultKind kind, time::SteadyTime now) const;
  [[nodiscard]] Bytes damaged(ByteView bytes, time::SteadyTime now);
  [[nodiscard]] bool happens(const Fault* fault);

  SerialDevice& device_;
  std::vector<Fault> faults_;
  std::mt19937_64 engine_;
  std::deque<Delayed> delayed_;
  time::SteadyTime now_{};
};

}  // namespace nodmap::sim
