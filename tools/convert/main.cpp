// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <exception>

#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "common/node/stop_signal.hpp"
#include "tools/convert/carmen_import.hpp"
#include "tools/convert/uos_import.hpp"

namespace {

struct Arguments {
  std::string in;
  std::string out;
  nodmap::convert::UosRange range;
};

CLI::App* add_import(CLI::App& app, Arguments& arguments, const char* name, const char* summary) {
  CLI::App* command = app.add_subcommand(name, summary);
  command->add_option("IN", arguments.in, "What to convert")->required();
  command->add_option("OUT", arguments.out, "LCM event log to make; never overwritten")->required();
  return command;
}

void add_commands(CLI::App& app, Arguments& arguments) {
  namespace convert = nodmap::convert;
  add_import(app, arguments, "carmen", "CARMEN log (.clf)")->callback([&arguments] {
    convert::import_carmen(arguments.in, arguments.out);
  });
  CLI::App* uos = add_import(app, arguments, "uos", "Folder of 3DTK scans (scanNNN.3d, .pose)");
  uos->add_option("--start", arguments.range.first, "Number of the first scan");
  uos->add_option("--end", arguments.range.last, "Number of the last scan");
  uos->callback(
      [&arguments] { convert::import_uos(arguments.in, arguments.out, arguments.range); });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Converts recordings to and from LCM event logs.", "nodmap-convert");
  app.set_version_flag("--version", NODMAP_VERSION);
  app.require_subcommand(1);
  Arguments arguments;
  add_commands(app, arguments);
  nodmap::log::start("nodmap-convert", "info");
  nodmap::node::catch_stop_signals();
  try {
    return nodmap::node::parse_command_line(app, argc, argv).value_or(0);
  } catch (const std::exception& error) {
    nodmap::log::get().error("{}", error.what());
    return 1;
  }
}
