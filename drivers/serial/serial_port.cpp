// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/serial_port.hpp"

#include <fcntl.h>
#include <libserialport.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "drivers/serial/descriptor_stream.hpp"
#include "drivers/serial/pty_port.hpp"

namespace nodmap::serial {
namespace {

struct PortDeleter {
  void operator()(sp_port* port) const { sp_free_port(port); }
};
using PortHandle = std::unique_ptr<sp_port, PortDeleter>;

/// The reason of the libserialport call that has just failed.
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

/// libserialport opens, configures and closes; bytes move through DescriptorStream, because the
/// library's own waits spin at full CPU on a device that was pulled out, cannot be ended from
/// outside, and (0.1.1) time out by the wall clock.
class SerialPort final : public DescriptorStream {
 public:
  SerialPort(PortHandle open_port, const StopEvent* stop)
      : DescriptorStream(descriptor_of(open_port.get()), stop), port_(std::move(open_port)) {}
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  SerialPort(SerialPort&&) = delete;
  SerialPort& operator=(SerialPort&&) = delete;
  ~SerialPort() override {
    if (exclusive_) {  // not where it is another's, as when the port was refused
      ::ioctl(poll_handle(), TIOCNXCL);
    }
    sp_close(port_.get());
  }

  [[nodiscard]] bool set_baud(int baud) override {
    return sp_set_baudrate(port_.get(), baud) == SP_OK;
  }
  void discard_input() override { sp_flush(port_.get(), SP_BUF_INPUT); }

  /// After sp_open parity and flow control are unknown: everything is set, nothing assumed.
  [[nodiscard]] bool configure(int baud) {
    return sp_set_baudrate(port_.get(), baud) == SP_OK && sp_set_bits(port_.get(), 8) == SP_OK &&
           sp_set_parity(port_.get(), SP_PARITY_NONE) == SP_OK &&
           sp_set_stopbits(port_.get(), 1) == SP_OK &&
           sp_set_flowcontrol(port_.get(), SP_FLOWCONTROL_NONE) == SP_OK;
  }

  /// libserialport 0.1.1 leaves the descriptor open to others and to child processes. TIOCEXCL
  /// keeps out every program but root's, the lock our own processes even then.
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
  auto open_port = std::make_unique<SerialPort>(std::move(port), settings.stop);
  if (!open_port->make_exclusive()) {
    return {nullptr, settings.device + ": in use by another process"};
  }
  if (!open_port->configure(settings.baud)) {
    return {nullptr, settings.device + ": does not do " + std::to_string(settings.baud) +
                         " bit/s 8N1: " + last_error()};
  }
  open_port->discard_input();
  return {std::move(open_port), {}};
}

}  // namespace

OpenResult open_serial_port(const PortSettings& settings) {
  // libserialport 0.1.1 looks names up in /sys/class/tty, where there are no links.
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
  if (is_pty(found.device)) {
    return open_pty(found);
  }
  return {nullptr, found.device + ": not a serial port"};
}

}  // namespace nodmap::serial
