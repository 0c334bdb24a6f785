// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/time.hpp"
#include "drivers/serial/serial_port.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::trial {

/// A serial line between a driver and an emulated device, on simulated time: what /dev/ttyUSB0 is
/// to the robot. Like a USB adapter it hands bytes over once in a while, whenever move_bytes() is
/// called, and its port disappears with an unplugged device. Outlives the streams it opens.
class SimulatedLine {
 public:
  explicit SimulatedLine(sim::SerialDevice& device) : device_(device) {}

  /// Carries what the device has sent up to now.
  void move_bytes(time::SteadyTime now);

  /// Opens the port for the driver; refused while the device is unplugged or the port is open.
  [[nodiscard]] serial::OpenResult open(int baud);

  /// The process that holds the port is gone: nothing it still writes arrives.
  void cut();

 private:
  class Stream;

  sim::SerialDevice& device_;
  time::SteadyTime now_{};
  int baud_ = 9600;
  std::vector<std::uint8_t> inbox_;
  Stream* stream_ = nullptr;  // of the driver, while it is connected
};

}  // namespace nodmap::trial
