// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "procman/config/config.hpp"

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

/// What an exec line asks for: `NAME=VALUE ... program arguments ...`.
struct ExecLine {
  std::vector<std::pair<std::string, std::string>> environment;
  std::vector<std::string> arguments;  ///< the program first; empty when the line names none
};

/// Looks up an environment variable; nothing when it is not set.
using Lookup = std::function<std::optional<std::string>(const std::string& name)>;

/// Takes an exec line apart as the existing deputy does, without a shell: words between blanks,
/// '...' and "..." hold blanks, a backslash takes the next character as it is; then $NAME and
/// ${NAME} in the program's words are replaced by the deputy's variables, and those that are not
/// set stay as typed.
[[nodiscard]] ExecLine parse_exec_line(std::string_view line, const Lookup& lookup);

/// What to run: words and environment as the kernel takes them.
struct Program {
  std::vector<std::string> arguments;    ///< the program first, looked up in `path` without a slash
  std::vector<std::string> environment;  ///< NAME=VALUE
  std::string search_path;               ///< folders, joined by ':'
  Resources resources;
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
