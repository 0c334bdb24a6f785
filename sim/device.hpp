// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace nodmap::sim {

/// A device at the far end of a serial line. Bytes and times only: a pseudo-terminal, a simulated
/// line and a test differ in who carries the bytes. Times are microseconds since the simulation's
/// start and never go back.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  Device(Device&&) = delete;
  Device& operator=(Device&&) = delete;
  virtual ~Device() = default;

  /// Bytes from the host, of which the last arrived now. `baud`: the rate at which the host sent
  /// them; at another rate than the device's they are noise.
  virtual void receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) = 0;

  /// Does what is due, and appends to `line` the bytes that have left the device up to now: a
  /// telegram of 372 bytes at 500 kbaud takes 7.4 ms and comes in pieces. `baud` is the rate at
  /// which the host listens; at another rate than the device's it gets noise.
  virtual void transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) = 0;

  /// When transmit() has something to do next; no need to call it before, unless bytes came.
  [[nodiscard]] virtual std::int64_t next_us() const = 0;

  /// False while the device is unplugged: its port is gone.
  [[nodiscard]] virtual bool plugged_in(std::int64_t /*now_us*/) const { return true; }
};

}  // namespace nodmap::sim
