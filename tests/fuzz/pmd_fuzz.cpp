// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a process configuration: it is valid and consistent, or has errors with their
// places.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "procman/config/parser.hpp"

namespace {

using namespace nodmap::procman;  // NOLINT(google-build-using-namespace): a program of one page

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void check(const Config& config) {
  for (const Command& command : config.commands) {
    require(config.find_command(command.id) == &command);
    require(!command.exec.empty());
    require(command.group.empty() || config.has_group(command.group));
    require(command.stop_signal >= 1 && command.stop_signal <= 64);
    require(command.stop_time_allowed_s >= 1);
  }
  for (const Script& script : config.scripts) {
    for (const Action& action : script.actions) {
      if (const auto* order = std::get_if<Order>(&action.what)) {
        require(order->target.kind != TargetKind::kCommand ||
                config.commands_of(order->target).size() == 1);
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const ParsedConfig parsed = parse_config(text);
  for (const ConfigError& error : parsed.errors) {
    require(error.place.line >= 1 && error.place.column >= 1 && !error.text.empty());
  }
  if (parsed.errors.empty()) {
    check(parsed.config);
  }
  return 0;
}
