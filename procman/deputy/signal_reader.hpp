// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "procman/deputy/child_process.hpp"

namespace nodmap::procman {

/// Reads the signals of the deputy from a descriptor. It uses no handlers, which a child could
/// inherit between fork and exec. Create it before any thread is started. It also ignores SIGPIPE,
/// because a closed log must not end the deputy.
class SignalReader {
 public:
  /// Blocks SIGCHLD, SIGINT, SIGTERM, SIGHUP and SIGQUIT. Throws std::system_error.
  SignalReader();

  /// The descriptor, readable while a signal is pending.
  [[nodiscard]] int poll_handle() const { return descriptor_.get(); }
  /// The next pending signal, if any.
  [[nodiscard]] std::optional<int> next();

 private:
  Descriptor descriptor_;
};

}  // namespace nodmap::procman
