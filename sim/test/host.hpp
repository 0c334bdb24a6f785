// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/devices/serial_device.hpp"
#include "tests/support/hex.hpp"

namespace nodmap::sim::test {

using nodmap::test::hex;
using nodmap::test::operator+;

inline Bytes text_bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

/// A time of the simulation.
constexpr time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

/// Bytes that a device sent together, and when transmit() returned them.
struct Portion {
  time::SteadyTime received{};
  Bytes bytes;
};

/// The host's end of a device's line, on simulated time. It calls transmit() only when the device
/// has something to send.
class Host {
 public:
  Host(SerialDevice& device, int baud) : device_(device), baud_(baud) {}

  int baud() const { return baud_; }
  void set_baud(int baud) { baud_ = baud; }
  time::SteadyTime now() const { return now_; }

  void send(ByteView bytes) { device_.receive(bytes, baud_, now_); }

  /// The bytes received up to a time, in portions.
  std::vector<Portion> portions_until(time::SteadyTime end) {
    std::vector<Portion> portions;
    while (true) {
      const time::SteadyTime next = std::max(now_, device_.next_due());
      now_ = std::min(next, end);
      if (before_) {
        before_(now_);
      }
      Portion portion{now_, {}};
      device_.transmit(now_, baud_, portion.bytes);
      if (!portion.bytes.empty()) {
        portions.push_back(portion);
      }
      if (next >= end) {
        return portions;
      }
    }
  }

  Bytes bytes_for(time::Duration duration) {
    Bytes all;
    for (const Portion& portion : portions_until(now_ + duration)) {
      append(all, portion.bytes);
    }
    return all;
  }

  /// Sends bytes; returns those received within `duration`.
  Bytes ask(ByteView bytes, time::Duration duration = 1500ms) {
    send(bytes);
    return bytes_for(duration);
  }

  /// Sets a function called before each transmit(), which can advance the world.
  void before_each(std::function<void(time::SteadyTime)> before) { before_ = std::move(before); }

 private:
  SerialDevice& device_;
  int baud_;
  time::SteadyTime now_{};
  std::function<void(time::SteadyTime)> before_;
};

}  // namespace nodmap::sim::test
