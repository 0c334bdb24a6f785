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

bool Permissions::may_run(const std::string& exec) const {
  return is_everything_ || std::ranges::find(commands_, exec, &Command::exec) != commands_.end();
}

Resources Permissions::resources_of(const std::string& id) const {
  const auto found = std::ranges::find(commands_, id, &Command::id);
  return found == commands_.end() ? Resources{} : found->resources;
}

}  // namespace nodmap::procman
