// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "sim/devices/serial_device.hpp"
#include "tests/support/hex.hpp"

namespace nodmap::sim::test {

using nodmap::test::hex;
using nodmap::test::operator+;

inline Bytes text_bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

/// A burst of bytes that left a device, and when transmit() gave it.
struct Portion {
  std::int64_t time_us = 0;
  Bytes bytes;
};

/// The host's end of a device's line, on simulated time: transmit() whenever the device asks for
/// it, and never else.
class Host {
 public:
  Host(SerialDevice& device, int baud) : device_(device), baud_(baud) {}

  int baud() const { return baud_; }
  void set_baud(int baud) { baud_ = baud; }
  std::int64_t now_us() const { return now_us_; }

  void send(ByteView bytes) { device_.receive(bytes, baud_, now_us_); }

  /// What comes up to a time, in portions.
  std::vector<Portion> portions_until(std::int64_t end_us) {
    std::vector<Portion> portions;
    while (true) {
      const std::int64_t next_us = std::max(now_us_, device_.next_us());
      now_us_ = std::min(next_us, end_us);
      if (before_) {
        before_(now_us_);
      }
      Portion portion{now_us_, {}};
      device_.transmit(now_us_, baud_, portion.bytes);
      if (!portion.bytes.empty()) {
        portions.push_back(portion);
      }
      if (next_us >= end_us) {
        return portions;
      }
    }
  }

  Bytes bytes_for(std::int64_t duration_us) {
    Bytes all;
    for (const Portion& portion : portions_until(now_us_ + duration_us)) {
      append(all, portion.bytes);
    }
    return all;
  }

  /// What comes within a time after these bytes.
  Bytes ask(ByteView bytes, std::int64_t duration_us = 1'500'000) {
    send(bytes);
    return bytes_for(duration_us);
  }

  /// Called before each transmit(), as a simulation moves its world on.
  void before_each(std::function<void(std::int64_t)> before) { before_ = std::move(before); }

 private:
  SerialDevice& device_;
  int baud_;
  std::int64_t now_us_ = 0;
  std::function<void(std::int64_t)> before_;
};

}  // namespace nodmap::sim::test
