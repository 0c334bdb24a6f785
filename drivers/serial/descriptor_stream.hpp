// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/serial/byte_stream.hpp"
#include "drivers/serial/stop_event.hpp"

namespace nodmap::serial {

/// Reads and writes a non-blocking descriptor that somebody else opened, configured and closes.
/// What serial lines and pseudo-terminals have in common.
class DescriptorStream : public ByteStream {
 public:
  /// `stop` may be null; otherwise it must outlive the stream.
  DescriptorStream(int fd, const StopEvent* stop) : fd_(fd), stop_(stop) {}

  [[nodiscard]] ReadResult read(std::span<std::uint8_t> buffer,
                                std::chrono::microseconds timeout) override;
  [[nodiscard]] IoStatus write(std::span<const std::uint8_t> bytes,
                               std::chrono::microseconds timeout) override;
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
