// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::serial {

/// Ends a wait from outside: once raised it stays raised. raise() may be called from another thread
/// and from a signal handler.
class StopEvent {
 public:
  /// Throws std::system_error when the process has no descriptors left.
  StopEvent();
  ~StopEvent();
  StopEvent(const StopEvent&) = delete;
  StopEvent& operator=(const StopEvent&) = delete;
  StopEvent(StopEvent&&) = delete;
  StopEvent& operator=(StopEvent&&) = delete;

  void raise() const noexcept;
  [[nodiscard]] bool raised() const noexcept;

  /// Readable from the moment the event is raised.
  [[nodiscard]] int poll_handle() const { return fd_; }

 private:
  int fd_;
};

}  // namespace nodmap::serial
