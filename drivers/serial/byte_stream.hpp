// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/geometry/time.hpp"

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

/// Bytes to and from a device. A failure is a value, not an exception: devices do get unplugged.
class ByteStream : private boost::noncopyable {
 public:
  virtual ~ByteStream() = default;

  /// Waits at most `timeout` for bytes (0: does not wait) and takes those that are there. A raised
  /// stop event ends the wait at once.
  [[nodiscard]] virtual ReadResult read(std::span<std::uint8_t> buffer, time::Duration timeout) = 0;

  /// Writes all of `bytes`, or as many as the device takes within `timeout`. The stop event does
  /// not shorten a write: the last thing a driver does is to write "stop".
  [[nodiscard]] virtual IoStatus write(std::span<const std::uint8_t> bytes,
                                       time::Duration timeout) = 0;

  /// Changes the line rate, bit/s; false when the device refuses it.
  [[nodiscard]] virtual bool set_baud(int baud) = 0;

  /// Drops what has arrived but has not been read.
  virtual void discard_input() = 0;

  /// False from the moment a read or write found the device gone.
  [[nodiscard]] virtual bool connected() const = 0;

  /// The descriptor to watch in a poll loop together with others; reading is still through read().
  [[nodiscard]] virtual int poll_handle() const = 0;
};

/// Ends a wait from outside: once raised it stays raised. raise() may be called from another thread
/// and from a signal handler.
class StopEvent : private boost::noncopyable {
 public:
  /// Throws std::system_error when the process has no descriptors left.
  StopEvent();
  ~StopEvent();

  void raise() const noexcept;
  [[nodiscard]] bool raised() const noexcept;

  /// Readable from the moment the event is raised.
  [[nodiscard]] int poll_handle() const { return fd_; }

 private:
  int fd_;
};

/// Reads and writes a non-blocking descriptor that the derived class opens, configures and closes:
/// what serial ports and pseudo-terminals have in common.
class DescriptorStream : public ByteStream {
 public:
  /// `stop` may be null; otherwise it must outlive the stream.
  DescriptorStream(int fd, const StopEvent* stop) : fd_(fd), stop_(stop) {}

  [[nodiscard]] ReadResult read(std::span<std::uint8_t> buffer, time::Duration timeout) override;
  [[nodiscard]] IoStatus write(std::span<const std::uint8_t> bytes,
                               time::Duration timeout) override;
  void discard_input() override;
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] int poll_handle() const override { return fd_; }

 private:
  [[nodiscard]] ReadResult read_now(std::span<std::uint8_t> buffer);

  int fd_;
  const StopEvent* stop_;
  bool connected_ = true;
};

}  // namespace nodmap::serial
