// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/pty_pair.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace nodmap::test {

PtyPair::PtyPair() {
  std::array<char, 128> name{};
  if (::openpty(&device_, &terminal_, name.data(), nullptr, nullptr) != 0) {
    throw std::system_error(errno, std::system_category(), "openpty");
  }
  name_ = name.data();
  for (const int fd : {device_, terminal_}) {
    ::fcntl(fd, F_SETFD, FD_CLOEXEC);
  }
  ::fcntl(device_, F_SETFL, O_NONBLOCK);
  termios attributes{};
  ::tcgetattr(terminal_, &attributes);
  ::cfmakeraw(&attributes);
  ::tcsetattr(terminal_, TCSANOW, &attributes);
}

PtyPair::~PtyPair() {
  unplug();
}

void PtyPair::send(std::span<const std::uint8_t> bytes) const {
  if (::write(device_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
    throw std::system_error(errno, std::system_category(), "cannot write to the pseudo-terminal");
  }
}

void PtyPair::send(const std::string& text) const {
  send(std::vector<std::uint8_t>(text.begin(), text.end()));
}

std::vector<std::uint8_t> PtyPair::receive(std::size_t least,
                                           std::chrono::milliseconds timeout) const {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  std::vector<std::uint8_t> received;
  std::array<std::uint8_t, 4096> chunk{};
  while (true) {
    const ssize_t count = ::read(device_, chunk.data(), chunk.size());
    if (count > 0) {
      received.insert(received.end(), chunk.begin(), chunk.begin() + count);
      continue;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    if (received.size() >= least || left.count() <= 0) {
      return received;
    }
    pollfd entry{device_, POLLIN, 0};
    ::poll(&entry, 1, static_cast<int>(left.count()));
  }
}

std::string PtyPair::receive_text(std::size_t least, std::chrono::milliseconds timeout) const {
  const std::vector<std::uint8_t> bytes = receive(least, timeout);
  return {bytes.begin(), bytes.end()};
}

void PtyPair::unplug() {
  for (int* fd : {&device_, &terminal_}) {
    if (*fd >= 0) {
      ::close(*fd);
      *fd = -1;
    }
  }
}

}  // namespace nodmap::test
