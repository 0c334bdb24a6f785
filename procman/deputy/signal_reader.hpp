// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::procman {

/// Reads the deputy's signals from a descriptor, without handlers: between fork and exec a child
/// would inherit them. Create it before any thread. It also ignores SIGPIPE, so that a closed log
/// does not end the deputy.
class SignalReader {
 public:
  /// Blocks SIGCHLD, SIGINT, SIGTERM, SIGHUP and SIGQUIT. Throws std::system_error.
  SignalReader();

  /// The descriptor, readable while a signal is pending.
  [[nodiscard]] int poll_handle() const { return descriptor_.get(); }
  /// The next pending signal, if any.
  [[nodiscard]] std::optional<int> next();

 private:
  formats::FileDescriptor descriptor_;
};

}  // namespace nodmap::procman
