// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/settings.hpp"

#include <set>
#include <utility>

namespace nodmap::procman {

bool allow(DeputySettings& settings, const Config& config) {
  std::set<std::string> allowed;
  for (const Command& command : config.commands) {
    if (command.deputy == settings.id) {
      allowed.insert(command.exec);
    }
  }
  const bool is_any = !allowed.empty();
  settings.may_run = [allowed = std::move(allowed)](const std::string& exec) {
    return allowed.contains(exec);
  };
  settings.resources_of = [config](const std::string& id) {
    const Command* command = config.find_command(id);
    return command == nullptr ? Resources{} : command->resources;
  };
  return is_any;
}

}  // namespace nodmap::procman
