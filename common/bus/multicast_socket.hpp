// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "common/bus/udpm_url.hpp"

namespace nodmap::bus {

/// Owns a file descriptor. Throws std::system_error with `what` if it is negative.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd, const char* what) : fd_(fd) {
    if (fd < 0) {
      throw std::system_error(errno, std::system_category(), what);
    }
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;
  ~FileDescriptor() {
    if (fd_ >= 0) {
      ::close(fd_);
    }
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

/// Opens a socket that receives the group's datagrams, each with the kernel's time of arrival and
/// the number of datagrams dropped so far. Throws std::system_error.
[[nodiscard]] FileDescriptor open_multicast_socket(const UdpmUrl& url);

}  // namespace nodmap::bus
