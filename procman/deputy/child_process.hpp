// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/formats/file_descriptor.hpp"
#include "procman/config/config.hpp"
#include "procman/config/exec_line.hpp"

namespace nodmap::procman {

/// Looks up an environment variable; empty if it is not set.
using Lookup = std::function<std::optional<std::string>(const std::string& name)>;

/// split_exec_line(), after which $NAME and ${NAME} in the program's words are replaced by the
/// deputy's variables; unset ones stay unchanged.
[[nodiscard]] ExecLine parse_exec_line(std::string_view line, const Lookup& lookup);

/// A program to run: arguments and environment as the kernel expects them.
struct Program {
  std::vector<std::string>
      arguments;  ///< the program first; looked up in `search_path` if it has no slash
  std::vector<std::string> environment;  ///< NAME=VALUE
  std::string search_path;               ///< folders, joined by ':'
  Resources resources;
};

struct Child {
  pid_t pid = -1;
  formats::FileDescriptor terminal;  ///< our side of its stdin, stdout and stderr; does not block
};

/// Starts a program without a shell, in a session, a process group and a terminal of its own. It
/// dies with its parent (SIGKILL) and inherits no descriptor, signal mask or handler. A signal sent
/// after this returns therefore kills it or reaches its own handler, never the deputy's. If the
/// program cannot be run, the child says so on its terminal and exits with code 127. Throws
/// std::system_error if no process can be created.
[[nodiscard]] Child start_child(const Program& program);

}  // namespace nodmap::procman
