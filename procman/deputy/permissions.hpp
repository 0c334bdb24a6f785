// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// Which exec lines a deputy may run, and with which resources. Orders alone do not suffice,
/// because LCM does not authenticate senders.
class Permissions {
 public:
  /// Permits nothing.
  Permissions() = default;
  /// Permits the commands that a configuration contains for a deputy.
  Permissions(const std::string& deputy_id, const Config& config);
  /// Permits every exec line, with the resources of the deputy.
  [[nodiscard]] static Permissions everything();

  [[nodiscard]] bool may_run(const std::string& exec) const;
  /// Whether no exec line is permitted.
  [[nodiscard]] bool is_empty() const { return commands_.empty() && !is_everything_; }

  /// The resources that a command may use.
  [[nodiscard]] Resources resources_of(const std::string& id) const;

 private:
  std::vector<Command> commands_;
  bool is_everything_ = false;
};

}  // namespace nodmap::procman
