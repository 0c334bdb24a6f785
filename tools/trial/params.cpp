// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/params.hpp"

#include "common/params/params.hpp"

namespace nodmap::trial {
namespace {

// Calls `visit(name, struct)` for each part.
template <class Visit>
void for_each_part(AllParams& all, const Visit& visit) {
  visit("loop", all.loop);
  visit("world", all.world);
  visit("sim", all.sim);
  visit("kurt", all.kurt);
  visit("laser3d", all.laser3d);
  visit("pitch_controller", all.pitch_controller);
  visit("map_server", all.map_server);
  visit("navigator", all.navigator);
  visit("explorer", all.explorer);
  visit("slam2d", all.slam2d);
  visit("slam6d", all.slam6d);
}

}  // namespace

void AllParams::set_assignment(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw params::ParamError("--set: '" + std::string(assignment) +
                             "' is not of the form process.key=value");
  }
  const std::size_t dot = assignment.substr(0, equals).find('.');
  const std::string_view process = assignment.substr(0, dot);
  bool found = false;
  std::string names;
  for_each_part(*this, [&](const char* name, auto& part) {
    names += names.empty() ? name : std::string(", ") + name;
    if (dot != std::string_view::npos && process == name) {
      params::Table(part).set(assignment.substr(dot + 1, equals - dot - 1),
                              assignment.substr(equals + 1), std::string("--set ") + name);
      found = true;
    }
  });
  if (!found) {
    throw params::ParamError("--set " + std::string(assignment) +
                             ": must begin with one of these and a dot: " + names);
  }
}

std::string AllParams::to_yaml() {
  std::string text;
  for_each_part(*this, [&text](const char* name, auto& part) {
    text += std::string("# --set ") + name + ".KEY=VALUE\n" + params::Table(part).to_yaml() + "\n";
  });
  return text;
}

}  // namespace nodmap::trial
