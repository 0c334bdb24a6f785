// SPDX-License-Identifier: BSD-3-Clause
// Common parts of all emulated devices: bytes, a device at the far end of a serial line, and the
// sending half of its port. Time starts at 0 with the simulation.
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::sim {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// Returned by next_due() when nothing is scheduled.
inline constexpr time::SteadyTime kNever = time::SteadyTime::max();

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

  /// Takes bytes from the host, the last of which arrived at `now`. `baud` is the rate at which
  /// the host sent them; at another rate than its own the device receives noise.
  virtual void receive(ByteView bytes, int baud, time::SteadyTime now) = 0;

  /// Does what is due, and appends to `line` the bytes that the device has sent up to `now`: a
  /// telegram of 372 bytes at 500 kbaud takes 7.4 ms and arrives in portions. `baud` is the rate at
  /// which the host listens; at another rate than the device's it receives noise.
  virtual void transmit(time::SteadyTime now, int baud, Bytes& line) = 0;

  /// The time at which transmit() must be called next, unless bytes arrive before.
  [[nodiscard]] virtual time::SteadyTime next_due() const = 0;

  /// False while the device is unplugged: its port is gone.
  [[nodiscard]] virtual bool is_plugged_in(time::SteadyTime /*now*/) const { return true; }
};

/// The sending half of a device's serial port: sends bytes one by one at the line's rate, 8N1.
class SerialOutput {
 public:
  /// Sends at `baud` from `from` on, or when all previous bytes have been sent.
  void send(Bytes bytes, int baud, time::SteadyTime from);
  /// Discards all bytes that have not been sent yet.
  void clear() { queue_.clear(); }

  /// Appends to `line` the bytes sent up to `now` as received by a host that listens at
  /// `host_baud`.
  void take(time::SteadyTime now, int host_baud, Bytes& line);

  /// When the next portion has been sent. Bytes arrive in portions, as from a USB adapter that
  /// waits a millisecond for more.
  [[nodiscard]] time::SteadyTime next_due() const;
  /// When all bytes have been sent; the earliest of all times if none wait.
  [[nodiscard]] time::SteadyTime idle_from() const;

 private:
  struct Telegram {
    Bytes bytes;
    int baud = 0;
    time::SteadyTime start{};
    std::size_t num_taken = 0;

    /// When the first `count` bytes have been sent.
    [[nodiscard]] time::SteadyTime sent(std::size_t count) const;
  };

  std::deque<Telegram> queue_;
};

/// The bytes that a receiver at `receiver_baud` gets from bytes sent back to back at `sender_baud`,
/// 8N1: it waits for a falling edge and then samples in the middle of its own bits. A byte without
/// stop bit becomes zero, as on Linux. Rates that differ by up to 4 % do no harm.
[[nodiscard]] Bytes received_bytes(int receiver_baud, ByteView bytes, int sender_baud);

}  // namespace nodmap::sim
