// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/config.hpp"

#include <algorithm>

namespace nodmap::procman {

const Command* Config::find_command(std::string_view id) const {
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [id](const Command& command) { return command.id == id; });
  return found == commands.end() ? nullptr : &*found;
}

const Script* Config::find_script(std::string_view name) const {
  const auto found = std::find_if(scripts.begin(), scripts.end(),
                                  [name](const Script& script) { return script.name == name; });
  return found == scripts.end() ? nullptr : &*found;
}

bool Config::has_group(std::string_view path) const {
  return std::find(groups.begin(), groups.end(), normalized_group(path)) != groups.end();
}

std::vector<const Command*> Config::commands_of(const Target& target) const {
  std::vector<const Command*> found;
  const std::string group = normalized_group(target.name);
  for (const Command& command : commands) {
    if (target.kind == TargetKind::kEverything ||
        (target.kind == TargetKind::kCommand && command.id == target.name) ||
        (target.kind == TargetKind::kGroup && is_in_group(command.group, group))) {
      found.push_back(&command);
    }
  }
  return found;
}

std::string normalized_group(std::string_view path) {
  std::string normalized;
  for (const char c : path) {
    if (c != '/' || (!normalized.empty() && normalized.back() != '/')) {
      normalized += c;
    }
  }
  if (!normalized.empty() && normalized.back() == '/') {
    normalized.pop_back();
  }
  return normalized;
}

bool is_in_group(std::string_view group, std::string_view ancestor) {
  return group == ancestor || (group.starts_with(ancestor) && group.size() > ancestor.size() &&
                               group[ancestor.size()] == '/');
}

}  // namespace nodmap::procman
