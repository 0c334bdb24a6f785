// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace nodmap::procman {

/// A file descriptor that is closed with its owner.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] int release();

 private:
  int fd_;
};

/// What to run: words and environment as the kernel takes them.
struct Program {
  std::vector<std::string> arguments;    ///< the program first, looked up in `path` without a slash
  std::vector<std::string> environment;  ///< NAME=VALUE
  std::string search_path;               ///< folders, joined by ':'
};

struct Child {
  pid_t pid = -1;
  Descriptor terminal;  ///< its stdin, stdout and stderr, from our side; does not block
};

/// Starts a program without a shell, in a session, a process group and a terminal of its own. It
/// dies with its parent (SIGKILL), inherits no descriptor, no signal mask and no handler: a signal
/// that is sent to it at any moment after this returns either kills it or reaches the program's own
/// handler, never the deputy's. When the program cannot be run, the child says so on its terminal
/// and exits with 127. Throws std::system_error where not even a process can be had.
[[nodiscard]] Child start_child(const Program& program);

}  // namespace nodmap::procman
