// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// Which commands a deputy may run, and with which resources. Orders alone do not suffice,
/// because LCM does not authenticate senders.
class Permissions {
 public:
  /// Permits nothing.
  Permissions() = default;
  /// Permits the commands that a configuration contains for a deputy.
  Permissions(const std::string& deputy_id, const Config& config);
  /// Permits every command, with the resources of the deputy.
  [[nodiscard]] static Permissions everything();

  /// The resources with which a command may run; empty if it may not run. Name and exec line must
  /// be those of one command: under other names, orders could start a program many times, or
  /// without its priority.
  [[nodiscard]] std::optional<Resources> resources_of(const std::string& id,
                                                      const std::string& exec) const;
  /// Whether no command is permitted.
  [[nodiscard]] bool is_empty() const { return commands_.empty() && !is_everything_; }

 private:
  std::vector<Command> commands_;
  bool is_everything_ = false;
};

}  // namespace nodmap::procman
