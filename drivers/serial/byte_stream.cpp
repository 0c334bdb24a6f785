// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/byte_stream.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace nodmap::serial {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

// Calls poll() until `deadline`, also after interruptions by signals; 0 on timeout.
int poll_until(pollfd entry, SteadyClock::time_point deadline) {
  while (true) {
    const auto left = std::max<nanoseconds>(deadline - SteadyClock::now(), nanoseconds(0));
    const timespec wait{left / 1s, left % 1s / 1ns};
    const int ready = ::ppoll(&entry, 1, &wait, nullptr);
    if (ready >= 0 || errno != EINTR) {
      return ready;
    }
  }
}

}  // namespace

ReadResult DescriptorStream::read(std::span<std::uint8_t> buffer, time::Duration timeout) {
  if (!connected_) {
    return {IoStatus::kDisconnected, 0};
  }
  if (buffer.empty() || poll_until({fd_, POLLIN, 0}, SteadyClock::now() + timeout) == 0) {
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
    if (poll_until({fd_, POLLOUT, 0}, deadline) == 0) {
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
