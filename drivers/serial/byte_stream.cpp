// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/byte_stream.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <system_error>

namespace nodmap::serial {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

// Calls poll() until `deadline`, also after interruptions by signals; 0 on timeout.
int poll_until(std::span<pollfd> entries, SteadyClock::time_point deadline) {
  while (true) {
    const auto left = std::max<nanoseconds>(deadline - SteadyClock::now(), nanoseconds(0));
    const timespec wait{left / 1s, left % 1s / 1ns};
    const int ready = ::ppoll(entries.data(), entries.size(), &wait, nullptr);
    if (ready >= 0 || errno != EINTR) {
      return ready;
    }
  }
}

}  // namespace

StopEvent::StopEvent() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (fd_ < 0) {
    throw std::system_error(errno, std::system_category(), "eventfd");
  }
}

StopEvent::~StopEvent() {
  ::close(fd_);
}

void StopEvent::raise() const noexcept {
  const std::uint64_t one = 1;
  // It can only fail if the counter is full, and then the event is already raised.
  [[maybe_unused]] const ssize_t written = ::write(fd_, &one, sizeof one);
}

bool StopEvent::raised() const noexcept {
  pollfd entry{fd_, POLLIN, 0};
  return ::poll(&entry, 1, 0) == 1;
}

ReadResult DescriptorStream::read(std::span<std::uint8_t> buffer, time::Duration timeout) {
  if (!connected_) {
    return {IoStatus::kDisconnected, 0};
  }
  // poll() ignores a negative descriptor.
  std::array<pollfd, 2> entries{{{fd_, POLLIN, 0}, {-1, POLLIN, 0}}};
  if (stop_ != nullptr) {
    entries[1].fd = stop_->poll_handle();
  }
  if (poll_until(entries, SteadyClock::now() + timeout) == 0) {
    return {IoStatus::kTimeout, 0};
  }
  if (entries[1].revents != 0) {
    return {IoStatus::kStopped, 0};
  }
  return read_now(buffer);
}

ReadResult DescriptorStream::read_now(std::span<std::uint8_t> buffer) {
  if (buffer.empty()) {
    return {IoStatus::kTimeout, 0};
  }
  const ssize_t count = ::read(fd_, buffer.data(), buffer.size());
  if (count > 0) {
    return {IoStatus::kOk, static_cast<std::size_t>(count)};
  }
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
    return {IoStatus::kTimeout, 0};
  }
  // A terminal that is readable but returns no byte has been hung up; EIO means the same.
  connected_ = false;
  return {IoStatus::kDisconnected, 0};
}

IoStatus DescriptorStream::write(std::span<const std::uint8_t> bytes, time::Duration timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  while (connected_ && !bytes.empty()) {
    const ssize_t count = ::write(fd_, bytes.data(), bytes.size());
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      continue;
    }
    if (count < 0 && errno != EAGAIN && errno != EINTR) {
      connected_ = false;
      break;
    }
    std::array<pollfd, 1> entry{{{fd_, POLLOUT, 0}}};
    if (poll_until(entry, deadline) == 0) {
      ::tcflush(fd_, TCOFLUSH);  // close() would wait up to 30 s until it is sent
      return IoStatus::kTimeout;
    }
  }
  return connected_ ? IoStatus::kOk : IoStatus::kDisconnected;
}

void DescriptorStream::discard_input() {
  ::tcflush(fd_, TCIFLUSH);
}

}  // namespace nodmap::serial
