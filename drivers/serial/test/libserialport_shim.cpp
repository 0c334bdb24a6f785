// SPDX-License-Identifier: BSD-3-Clause
// Makes libserialport accept a pseudo-terminal as a serial port, in a test program that links this
// file: the dynamic linker finds these functions before those of the C library. libserialport looks
// the port up in /sys/class/tty and reads its modem lines; a pseudo-terminal has neither.
#include "drivers/serial/test/libserialport_shim.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <string_view>

namespace nodmap::test {
namespace {

std::atomic<int> g_modem_line_reads = 0;  // NOLINT: C functions have nowhere else to write to

bool is_pty_in_sysfs(std::string_view path) {
  return path.starts_with("/sys/class/tty/pts/");
}

int claim_link(struct stat* status) {
  *status = {};
  status->st_mode = S_IFLNK;
  return 0;
}

}  // namespace

int modem_line_reads() {
  return g_modem_line_reads;
}

}  // namespace nodmap::test

// NOLINTBEGIN: the C library's names and signatures
extern "C" {

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  const int result = static_cast<int>(::syscall(SYS_ioctl, fd, request, argument));
  if (result == 0 || (errno != ENOTTY && errno != EINVAL)) {
    return result;
  }
  if (request == TIOCMGET) {
    ++nodmap::test::g_modem_line_reads;
    *static_cast<int*>(argument) = TIOCM_CTS | TIOCM_DSR;
    return 0;
  }
  return request == TIOCMBIS || request == TIOCMBIC || request == TIOCMSET ? 0 : result;
}

int lstat(const char* path, struct stat* status) noexcept {
  return nodmap::test::is_pty_in_sysfs(path)
             ? nodmap::test::claim_link(status)
             : ::fstatat(AT_FDCWD, path, status, AT_SYMLINK_NOFOLLOW);
}

int __lxstat(int, const char* path, struct stat* status) noexcept {
  return lstat(path, status);
}

ssize_t readlink(const char* path, char* buffer, size_t size) noexcept {
  if (nodmap::test::is_pty_in_sysfs(path)) {
    constexpr std::string_view kTarget = "../../devices/virtual/tty/pts";
    const size_t count = std::min(size, kTarget.size());
    std::copy_n(kTarget.data(), count, buffer);
    return static_cast<ssize_t>(count);
  }
  return ::syscall(SYS_readlink, path, buffer, size);
}

}  // extern "C"
// NOLINTEND
