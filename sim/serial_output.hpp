// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>

#include "sim/bytes.hpp"

namespace nodmap::sim {

/// The sending half of a device's serial port: bytes leave one after the other at the line's rate,
/// 8N1. Times are microseconds since the simulation's start.
class SerialOutput {
 public:
  /// Sends at `baud` from `from_us` on, or as soon as what was sent before has left.
  void send(Bytes bytes, int baud, std::int64_t from_us);
  /// Breaks off what has not left.
  void clear() { queue_.clear(); }

  /// Appends to `line` what has left up to now, as a host hears it that listens at `host_baud`.
  void take(std::int64_t now_us, int host_baud, Bytes& line);

  /// When something will have left: the bytes of a telegram come in portions, as from a USB adapter
  /// that waits a millisecond for more.
  [[nodiscard]] std::int64_t next_us() const;
  /// When everything will have left; long ago when nothing waits.
  [[nodiscard]] std::int64_t free_us() const;

 private:
  struct Telegram {
    Bytes bytes;
    int baud = 0;
    std::int64_t start_us = 0;
    std::size_t taken = 0;

    /// When so many bytes have left.
    [[nodiscard]] std::int64_t left_us(std::size_t count) const;
  };

  std::deque<Telegram> queue_;
};

}  // namespace nodmap::sim
