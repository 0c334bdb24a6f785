// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/time.hpp"
#include "drivers/serial/serial_port.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::trial {

/// A serial line between a driver and an emulated device, on simulated time, in the place of the
/// robot's /dev/ttyUSB0. Like a USB adapter it delivers bytes in portions, at each call of
/// move_bytes(), and its port disappears when the device is unplugged. Must outlive the streams
/// that it opens.
class SimulatedLine {
 public:
  explicit SimulatedLine(sim::SerialDevice& device) : device_(device) {}

  /// Delivers what the device has sent up to now.
  void move_bytes(time::SteadyTime now);

  /// Opens the port for the driver; refused while the device is unplugged or the port is open.
  [[nodiscard]] serial::OpenResult open(int baud);

  /// Cuts the line, because the process that has the port open was killed: nothing that it still
  /// writes arrives.
  void cut();

 private:
  class Stream;

  sim::SerialDevice& device_;
  time::SteadyTime now_{};
  int baud_ = 9600;
  std::vector<std::uint8_t> inbox_;
  Stream* stream_ = nullptr;  // the driver's stream, while it is connected
};

}  // namespace nodmap::trial
