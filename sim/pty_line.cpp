// SPDX-License-Identifier: BSD-3-Clause
#include "sim/pty_line.hpp"

#include <asm/termbits.h>  // termios2, with rates as numbers; not to be mixed with <termios.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "common/formats/folder.hpp"

namespace nodmap::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = ".nodmap-sim.lock";

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::system_category(), what);
}

// Sets raw mode: no echo, line editing or signals.
void make_raw(int fd) {
  termios2 attributes{};
  if (::ioctl(fd, TCGETS2, &attributes) != 0) {
    fail("pseudo-terminal");
  }
  attributes.c_iflag = 0;
  attributes.c_oflag = 0;
  attributes.c_lflag = 0;
  attributes.c_cflag = CS8 | CREAD | CLOCAL | B9600;
  if (::ioctl(fd, TCSETS2, &attributes) != 0) {
    fail("pseudo-terminal");
  }
}

}  // namespace

LinkDir::LinkDir(fs::path path) : path_(std::move(path)), is_made_(formats::make_folder(path_)) {
  lock_ = ::open((path_ / kLockName).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock_ < 0) {
    fail((path_ / kLockName).string());
  }
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw std::runtime_error(path_.string() + ": in use by another simulator");
  }
}

LinkDir::~LinkDir() {
  std::error_code ignored;
  fs::remove(path_ / kLockName, ignored);
  ::close(lock_);
  if (is_made_) {
    fs::remove(path_, ignored);
  }
}

void LinkDir::link(const std::string& name, const std::string& terminal) const {
  const fs::path file = path_ / name;
  const fs::file_status status = fs::symlink_status(file);
  if (fs::exists(status)) {
    if (!fs::is_symlink(status) || !fs::read_symlink(file).string().starts_with("/dev/pts/")) {
      throw std::runtime_error(file.string() + ": exists and is not a link of the simulator");
    }
    fs::remove(file);
  }
  fs::create_symlink(terminal, file);
}

void LinkDir::unlink(const std::string& name) const {
  std::error_code ignored;
  fs::remove(path_ / name, ignored);
}

void PtyLine::plug_in() {
  device_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> terminal{};
  if (device_ < 0 || ::grantpt(device_) != 0 || ::unlockpt(device_) != 0 ||
      ::ptsname_r(device_, terminal.data(), terminal.size()) != 0) {
    fail("pseudo-terminal");
  }
  terminal_ = ::open(terminal.data(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (terminal_ < 0) {
    fail(terminal.data());
  }
  make_raw(terminal_);
  dir_.link(name_, terminal.data());
  is_linked_ = true;
}

void PtyLine::unplug() {
  if (!is_plugged_in()) {
    return;
  }
  if (std::exchange(is_linked_, false)) {
    dir_.unlink(name_);
  }
  if (terminal_ >= 0) {
    ::close(std::exchange(terminal_, -1));
  }
  ::close(std::exchange(device_, -1));
}

int PtyLine::host_baud() const {
  termios2 attributes{};
  ::ioctl(device_, TCGETS2, &attributes);
  return static_cast<int>(attributes.c_ospeed);
}

Bytes PtyLine::read() const {
  std::array<std::uint8_t, 4096> chunk{};
  const ssize_t count = ::read(device_, chunk.data(), chunk.size());
  return {chunk.begin(), chunk.begin() + std::max<ssize_t>(count, 0)};
}

void PtyLine::write(ByteView bytes) const {
  // If the terminal is full, the rest of the portion is lost.
  [[maybe_unused]] const ssize_t count = ::write(device_, bytes.data(), bytes.size());
}

}  // namespace nodmap::sim
