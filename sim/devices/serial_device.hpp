// SPDX-License-Identifier: BSD-3-Clause
// What all emulated devices share: bytes, the device at the far end of a serial line, and the
// sending half of its port. Times are microseconds since the start of the simulation.
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <vector>

namespace nodmap::sim {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// Returned by next_us() when nothing is scheduled.
inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

void append(Bytes& bytes, ByteView more);

/// Appends the lowest `count` bytes of `value`, lowest first.
void append_little_endian(Bytes& bytes, std::uint32_t value, int count);

/// The number stored lowest byte first; at most four bytes.
[[nodiscard]] std::uint32_t little_endian(ByteView bytes);

/// An emulated device at the far end of a serial line. It handles bytes and times only, so that a
/// pseudo-terminal, a simulated line or a test can carry the bytes. Times never go back.
class SerialDevice : private boost::noncopyable {
 public:
  virtual ~SerialDevice() = default;

  /// Takes bytes from the host, the last of which arrived at `now_us`. `baud` is the rate at which
  /// the host sent them; at another rate than its own the device receives noise.
  virtual void receive(ByteView bytes, int baud, std::int64_t now_us) = 0;

  /// Does what is due, and appends to `line` the bytes that have left the device up to `now_us`: a
  /// telegram of 372 bytes at 500 kbaud takes 7.4 ms and arrives in portions. `baud` is the rate at
  /// which the host listens; at another rate than the device's it receives noise.
  virtual void transmit(std::int64_t now_us, int baud, Bytes& line) = 0;

  /// The next time at which transmit() has something to do, unless bytes arrive before.
  [[nodiscard]] virtual std::int64_t next_us() const = 0;

  /// False while the device is unplugged: its port is gone.
  [[nodiscard]] virtual bool plugged_in(std::int64_t /*now_us*/) const { return true; }
};

/// The sending half of a device's serial port: bytes leave one after the other at the line's rate,
/// 8N1.
class SerialOutput {
 public:
  /// Sends at `baud` from `from_us` on, or as soon as all bytes sent before have left.
  void send(Bytes bytes, int baud, std::int64_t from_us);
  /// Discards all bytes that have not left yet.
  void clear() { queue_.clear(); }

  /// Appends to `line` the bytes that have left up to `now_us`, as a host receives them that
  /// listens at `host_baud`.
  void take(std::int64_t now_us, int host_baud, Bytes& line);

  /// When the next portion will have left: bytes arrive in portions, as from a USB adapter that
  /// waits a millisecond for more.
  [[nodiscard]] std::int64_t next_us() const;
  /// When all bytes will have left; the smallest number when none wait.
  [[nodiscard]] std::int64_t idle_from_us() const;

 private:
  struct Telegram {
    Bytes bytes;
    int baud = 0;
    std::int64_t start_us = 0;
    std::size_t num_taken = 0;

    /// When the first `count` bytes have left.
    [[nodiscard]] std::int64_t sent_us(std::size_t count) const;
  };

  std::deque<Telegram> queue_;
};

/// What a receiver at `receiver_baud` makes of bytes sent back to back at `sender_baud`, 8N1: it
/// waits for a falling edge and then samples in the middle of its own bits. A byte without stop bit
/// becomes zero, as on Linux. Rates that differ by up to 4 % do no harm.
[[nodiscard]] Bytes received_bytes(int receiver_baud, ByteView bytes, int sender_baud);

}  // namespace nodmap::sim
