// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/pty_port.hpp"

#include <asm/termbits.h>  // termios2, with rates as numbers; not to be mixed with <termios.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "drivers/serial/descriptor_stream.hpp"

namespace nodmap::serial {
namespace {

/// Raw, at any rate. A pseudo-terminal moves bytes at every rate alike; the one set is what a
/// simulated device can read back to refuse a driver that speaks at the wrong one.
bool set_raw(int fd, int baud) {
  termios2 attributes{};
  if (baud <= 0 || ::ioctl(fd, TCGETS2, &attributes) != 0) {
    return false;
  }
  attributes.c_iflag = 0;
  attributes.c_oflag = 0;
  attributes.c_lflag = 0;
  attributes.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  attributes.c_ispeed = static_cast<speed_t>(baud);
  attributes.c_ospeed = static_cast<speed_t>(baud);
  return ::ioctl(fd, TCSETS2, &attributes) == 0;
}

class PtyPort final : public DescriptorStream {
 public:
  PtyPort(int fd, const StopEvent* stop) : DescriptorStream(fd, stop) {}
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;
  PtyPort(PtyPort&&) = delete;
  PtyPort& operator=(PtyPort&&) = delete;
  ~PtyPort() override { ::close(poll_handle()); }

  [[nodiscard]] bool set_baud(int baud) override { return set_raw(poll_handle(), baud); }
};

}  // namespace

bool is_pty(const std::string& resolved_device) {
  return resolved_device.starts_with("/dev/pts/");
}

bool lock_device(int fd) {
  return ::flock(fd, LOCK_EX | LOCK_NB) == 0;
}

OpenResult open_pty(const PortSettings& settings) {
  const int fd = ::open(settings.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    return {nullptr, settings.device + ": " + std::system_category().message(errno)};
  }
  auto port = std::make_unique<PtyPort>(fd, settings.stop);
  if (!lock_device(fd)) {
    return {nullptr, settings.device + ": in use by another process"};
  }
  if (!port->set_baud(settings.baud)) {
    return {nullptr, settings.device + ": does not do " + std::to_string(settings.baud) + " bit/s"};
  }
  return {std::move(port), {}};
}

}  // namespace nodmap::serial
