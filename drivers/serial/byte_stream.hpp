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
  kTimeout,       ///< nothing read, or not everything written, within the timeout
  kDisconnected,  ///< the device is gone; this stream cannot recover, open a new one
};

struct ReadResult {
  IoStatus status = IoStatus::kOk;
  std::size_t count = 0;  ///< bytes read; more than 0 exactly when the status is kOk
};

/// Bytes to and from a device. Failures are return values, not exceptions, because devices do get
/// unplugged.
class ByteStream : private boost::noncopyable {
 public:
  virtual ~ByteStream() = default;

  /// Reads the bytes that are available, waiting for them at most `timeout` (0: does not wait).
  [[nodiscard]] virtual ReadResult read(std::span<std::uint8_t> buffer, time::Duration timeout) = 0;

  /// Writes all of `bytes`, or as many as the device accepts within `timeout`; after a time-out,
  /// what it has not sent yet is dropped.
  [[nodiscard]] virtual IoStatus write(std::span<const std::uint8_t> bytes,
                                       time::Duration timeout) = 0;

  /// Changes the line rate, bit/s; false when the device refuses it.
  [[nodiscard]] virtual bool set_baud(int baud) = 0;

  /// Drops bytes that have arrived but have not been read.
  virtual void discard_input() = 0;

  /// False from the moment a read or write found the device gone.
  [[nodiscard]] virtual bool connected() const = 0;

  /// The descriptor, to be used with others in poll(). Read through read() only.
  [[nodiscard]] virtual int poll_handle() const = 0;
};

/// Reads and writes a non-blocking descriptor; the derived class opens, configures and closes it.
/// The common part of serial ports and pseudo-terminals.
class DescriptorStream : public ByteStream {
 public:
  explicit DescriptorStream(int fd) : fd_(fd) {}

  [[nodiscard]] ReadResult read(std::span<std::uint8_t> buffer, time::Duration timeout) override;
  [[nodiscard]] IoStatus write(std::span<const std::uint8_t> bytes,
                               time::Duration timeout) override;
  void discard_input() override;
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] int poll_handle() const override { return fd_; }

 private:
  int fd_;
  bool connected_ = true;
};

}  // namespace nodmap::serial
