// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/serial_port.hpp"

#include <asm/termbits.h>  // termios2, with rates as numbers; not to be mixed with <termios.h>
#include <fcntl.h>
#include <libserialport.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace nodmap::serial {
namespace {

// Takes the lock that all our processes use for a device; false if another process has it. The
// kernel releases it when its owner ends in any way.
bool lock_device(int fd) {
  return ::flock(fd, LOCK_EX | LOCK_NB) == 0;
}

OpenResult in_use(const std::string& device) {
  return {nullptr, device + ": in use by another process"};
}

struct PortDeleter {
  void operator()(sp_port* port) const { sp_free_port(port); }
};
using PortHandle = std::unique_ptr<sp_port, PortDeleter>;

// The reason why the last libserialport call has failed.
std::string last_error() {
  char* message = sp_last_error_message();
  std::string text = message != nullptr ? message : "unknown error";
  sp_free_error_message(message);
  return text;
}

int descriptor_of(const sp_port* port) {
  int fd = -1;
  sp_get_port_handle(port, &fd);
  return fd;
}

// libserialport opens, configures and closes the port. Bytes are transferred by DescriptorStream,
// because the library's own waits busy-loop on a device that was pulled out, cannot be
// interrupted, and (0.1.1) measure timeouts by the wall clock.
class SerialPort final : public DescriptorStream {
 public:
  explicit SerialPort(PortHandle open_port)
      : DescriptorStream(descriptor_of(open_port.get())), port_(std::move(open_port)) {}
  ~SerialPort() override {
    if (exclusive_) {  // not if another process owns the port
      ::ioctl(poll_handle(), TIOCNXCL);
    }
    sp_close(port_.get());
  }

  [[nodiscard]] bool set_baud(int baud) override {
    return sp_set_baudrate(port_.get(), baud) == SP_OK;
  }
  void discard_input() override { sp_flush(port_.get(), SP_BUF_INPUT); }

  // Sets everything, because parity and flow control are unknown after sp_open.
  [[nodiscard]] bool configure(int baud) {
    return sp_set_baudrate(port_.get(), baud) == SP_OK && sp_set_bits(port_.get(), 8) == SP_OK &&
           sp_set_parity(port_.get(), SP_PARITY_NONE) == SP_OK &&
           sp_set_stopbits(port_.get(), 1) == SP_OK &&
           sp_set_flowcontrol(port_.get(), SP_FLOWCONTROL_NONE) == SP_OK;
  }

  // libserialport 0.1.1 shares the descriptor with other programs and child processes. TIOCEXCL
  // excludes all programs except root's; the lock also excludes our own processes that run as
  // root.
  [[nodiscard]] bool make_exclusive() {
    exclusive_ = ::fcntl(poll_handle(), F_SETFD, FD_CLOEXEC) == 0 && lock_device(poll_handle()) &&
                 ::ioctl(poll_handle(), TIOCEXCL) == 0;
    return exclusive_;
  }

 private:
  PortHandle port_;
  bool exclusive_ = false;
};

std::string advice(int error) {
  switch (error) {
    case EACCES:
      return " (is the user in the group dialout?)";
    case EBUSY:
    case EAGAIN:
      return " (in use by another process)";
    default:
      return "";
  }
}

OpenResult open_with_libserialport(PortHandle port, const PortSettings& settings) {
  if (sp_open(port.get(), SP_MODE_READ_WRITE) != SP_OK) {
    const int error = sp_last_error_code();
    return {nullptr, settings.device + ": " + last_error() + advice(error)};
  }
  auto open_port = std::make_unique<SerialPort>(std::move(port));
  if (!open_port->make_exclusive()) {
    return in_use(settings.device);
  }
  if (!open_port->configure(settings.baud)) {
    return {nullptr, settings.device + ": does not support " + std::to_string(settings.baud) +
                         " bit/s 8N1: " + last_error()};
  }
  open_port->discard_input();
  return {std::move(open_port), {}};
}

// Sets raw mode and any rate. A pseudo-terminal works the same at every rate; a simulated device
// can read the rate back and reject a driver that uses the wrong one.
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
  explicit PtyPort(int fd) : DescriptorStream(fd) {}
  ~PtyPort() override { ::close(poll_handle()); }

  [[nodiscard]] bool set_baud(int baud) override { return set_raw(poll_handle(), baud); }
};

OpenResult open_pty(const PortSettings& settings) {
  const int fd = ::open(settings.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    return {nullptr, settings.device + ": " + std::system_category().message(errno)};
  }
  auto port = std::make_unique<PtyPort>(fd);
  if (!lock_device(fd)) {
    return in_use(settings.device);
  }
  if (!port->set_baud(settings.baud)) {
    return {nullptr,
            settings.device + ": does not support " + std::to_string(settings.baud) + " bit/s"};
  }
  return {std::move(port), {}};
}

}  // namespace

OpenResult open_serial_port(const PortSettings& settings) {
  // libserialport 0.1.1 looks up names in /sys/class/tty, which has no entries for links.
  std::error_code error;
  const std::filesystem::path resolved = std::filesystem::canonical(settings.device, error);
  if (error) {
    return {nullptr, settings.device + ": " + error.message()};
  }
  PortSettings found = settings;
  found.device = resolved.string();
  sp_port* port = nullptr;
  if (sp_get_port_by_name(found.device.c_str(), &port) == SP_OK) {
    return open_with_libserialport(PortHandle(port), found);
  }
  if (found.device.starts_with("/dev/pts/")) {
    return open_pty(found);
  }
  return {nullptr, found.device + ": not a serial port"};
}

}  // namespace nodmap::serial
