// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/geometry/time.hpp"
#include "drivers/serial/back_off.hpp"
#include "drivers/serial/serial_port.hpp"

namespace nodmap::serial {

/// Keeps the line to a device open: opens it, reads it, detects its loss, reopens it with growing
/// pauses, and logs both. It has no clock of its own; the caller passes the time.
class SerialLink : private boost::noncopyable {
 public:
  using Opener = std::function<OpenResult()>;

  /// Called when the line has been opened, has received bytes, and has been lost.
  struct Handlers {
    std::function<void(const time::Moment& now)> opened;
    std::function<void(std::span<const std::uint8_t> bytes, const time::Moment& now)> received;
    std::function<void()> lost;
  };

  /// A line that does not accept its bytes within `timeout` counts as lost. `byte_pause`: pause
  /// after each byte, for devices that need one.
  struct WriteOptions {
    time::Duration timeout = 50ms;
    time::Duration byte_pause{};
  };

  /// `name`: the device's name in the log.
  SerialLink(std::string name, Opener open, Handlers handlers);

  /// Opens the line when an attempt is due; while it is open, passes received bytes to the handler.
  /// Does not wait.
  void poll(const time::Moment& now);

  /// Writes all of `bytes`. If that fails, returns false and the line counts as lost. Does nothing
  /// while closed.
  bool write(std::span<const std::uint8_t> bytes, const time::Moment& now,
             const WriteOptions& options);

  /// Changes the line rate, bit/s, and drops bytes that have arrived at the old one.
  void set_baud(int baud);

  /// Closes the line and reopens it later, for example because the device does not answer. `reason`
  /// becomes the error.
  void give_up(const time::Moment& now, const std::string& reason);

  /// Closes the line for good.
  void end();

  [[nodiscard]] bool is_open() const { return stream_ != nullptr; }

  /// Why the line is closed, in one sentence; empty while it is open.
  [[nodiscard]] const std::string& error() const { return error_; }

  /// The descriptor to watch for bytes; -1 while closed.
  [[nodiscard]] int poll_handle() const { return is_open() ? stream_->poll_handle() : -1; }

  /// How often the line was opened after the first time.
  [[nodiscard]] std::int64_t reconnects() const { return opened_ > 0 ? opened_ - 1 : 0; }

 private:
  void open(const time::Moment& now);
  void close(const std::string& reason);
  [[nodiscard]] IoStatus write_all(std::span<const std::uint8_t> bytes,
                                   const WriteOptions& options);

  std::string name_;
  Opener open_;
  Handlers handlers_;
  std::unique_ptr<ByteStream> stream_;
  BackOff back_off_;
  std::string error_ = "not opened yet";
  time::SteadyTime opened_at_;
  std::int64_t opened_ = 0;
  bool ended_ = false;
};

/// Opens the serial port `device` at `baud` bit/s.
[[nodiscard]] SerialLink::Opener port_opener(const std::string& device, int baud);

}  // namespace nodmap::serial
