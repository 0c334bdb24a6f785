// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/permissions.hpp"

#include <algorithm>
#include <iterator>

namespace nodmap::procman {

Permissions::Permissions(const std::string& deputy_id, const Config& config) {
  std::ranges::copy_if(config.commands, std::back_inserter(commands_),
                       [&](const Command& command) { return command.deputy == deputy_id; });
}

Permissions Permissions::everything() {
  Permissions permissions;
  permissions.is_everything_ = true;
  return permissions;
}

std::optional<Resources> Permissions::resources_of(const std::string& id,
                                                   const std::string& exec) const {
  if (is_everything_) {
    return Resources{};
  }
  const auto found = std::ranges::find(commands_, id, &Command::id);
  return found != commands_.end() && found->exec == exec ? std::optional(found->resources)
                                                         : std::nullopt;
}

}  // namespace nodmap::procman
