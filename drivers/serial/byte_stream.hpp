// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace nodmap::serial {

enum class IoStatus : std::uint8_t {
  kOk,
  kTimeout,       ///< nothing (read) or not everything (write) within the time given
  kStopped,       ///< the stop event was raised while waiting to read
  kDisconnected,  ///< the device is gone; this stream will not come back, open another
};

struct ReadResult {
  IoStatus status = IoStatus::kOk;
  std::size_t count = 0;  ///< bytes read; more than 0 exactly when the status is kOk
};

/// Bytes to and from a device. A failure is a value: a device that is pulled out is no exception.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  ByteStream(ByteStream&&) = delete;
  ByteStream& operator=(ByteStream&&) = delete;
  virtual ~ByteStream() = default;

  /// Waits until there are bytes, at most `timeout` (0: does not wait), and takes what is there. A
  /// raised stop event ends the wait at once.
  [[nodiscard]] virtual ReadResult read(std::span<std::uint8_t> buffer,
                                        std::chrono::microseconds timeout) = 0;

  /// Writes all of `bytes`, or as much as the device takes within `timeout`. The stop event does
  /// not shorten it: the last thing a driver does is to write "stop".
  [[nodiscard]] virtual IoStatus write(std::span<const std::uint8_t> bytes,
                                       std::chrono::microseconds timeout) = 0;

  /// Changes the line rate, bit/s; false when the device refuses it.
  [[nodiscard]] virtual bool set_baud(int baud) = 0;

  /// Forgets what has arrived but was not read yet.
  virtual void discard_input() = 0;

  /// False from the moment a read or write found the device gone.
  [[nodiscard]] virtual bool connected() const = 0;

  /// The descriptor to watch in a poll loop together with others; reading is still through read().
  [[nodiscard]] virtual int poll_handle() const = 0;
};

}  // namespace nodmap::serial
