// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/stop_event.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace nodmap::serial {

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
  // The only failure is a counter that is full, and then the event is raised already.
  [[maybe_unused]] const ssize_t written = ::write(fd_, &one, sizeof one);
}

bool StopEvent::raised() const noexcept {
  pollfd entry{fd_, POLLIN, 0};
  return ::poll(&entry, 1, 0) == 1;
}

}  // namespace nodmap::serial
