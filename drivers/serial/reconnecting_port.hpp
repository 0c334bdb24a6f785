// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "drivers/serial/back_off.hpp"
#include "drivers/serial/serial_port.hpp"

namespace nodmap::serial {

/// A port that is there again when its device is: opens it, and after a loss opens it anew, with
/// growing pauses. It has no clock of its own; times are those of one monotonic clock.
class ReconnectingPort {
 public:
  using Opener = std::function<OpenResult()>;

  explicit ReconnectingPort(Opener open) : open_(std::move(open)) {}

  /// The open stream. Otherwise, when an attempt is due, tries once to open; null when that fails
  /// or none is due.
  ByteStream* stream(std::int64_t now_us);

  /// Closes the stream, to open it again: because it is disconnected or the device does not answer.
  /// `reason` becomes the error.
  void give_up(std::int64_t now_us, const std::string& reason);

  [[nodiscard]] bool is_open() const { return stream_ != nullptr; }

  /// Why there is no stream, in one sentence; empty while there is.
  [[nodiscard]] const std::string& error() const { return error_; }

  /// Time until the next attempt, microseconds; 0 while open.
  [[nodiscard]] std::int64_t wait_us(std::int64_t now_us) const {
    return is_open() ? 0 : back_off_.wait_us(now_us);
  }

  /// How often it was opened after the first time.
  [[nodiscard]] std::int64_t reconnects() const { return opened_ > 0 ? opened_ - 1 : 0; }

 private:
  Opener open_;
  std::unique_ptr<ByteStream> stream_;
  BackOff back_off_;
  std::string error_ = "not opened yet";
  std::int64_t opened_us_ = 0;
  std::int64_t opened_ = 0;
};

}  // namespace nodmap::serial
