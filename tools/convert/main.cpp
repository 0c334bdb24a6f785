// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>

#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "tools/convert/carmen_export.hpp"
#include "tools/convert/carmen_import.hpp"
#include "tools/convert/cloud_export.hpp"
#include "tools/convert/log_summary.hpp"
#include "tools/convert/mcap_export.hpp"
#include "tools/convert/nod_import.hpp"
#include "tools/convert/table_export.hpp"
#include "tools/convert/uos_export.hpp"
#include "tools/convert/uos_import.hpp"

namespace {

namespace convert = nodmap::convert;

struct Arguments {
  std::string in;
  std::string out;
  std::string channel;
  convert::UosRange range;
  convert::CloudWindow window;
  std::function<void()> work;  // the work of the chosen subcommand
};

CLI::App* add_command(CLI::App& app, Arguments& arguments, const char* name, const char* summary) {
  CLI::App* command = app.add_subcommand(name, summary);
  command->add_option("IN", arguments.in, "File or folder to read")->required();
  return command;
}

CLI::App* add_import(CLI::App& app, Arguments& arguments, const char* name, const char* summary) {
  CLI::App* command = add_command(app, arguments, name, summary);
  command->add_option("OUT", arguments.out, "LCM event log to write; never overwritten")
      ->required();
  return command;
}

void add_imports(CLI::App& app, Arguments& arguments) {
  add_import(app, arguments, "carmen", "CARMEN log (.clf) to an LCM event log")
      ->callback([&arguments] {
        arguments.work = [&] { convert::import_carmen(arguments.in, arguments.out); };
      });
  add_import(app, arguments, "nod",
             "Line-by-line recording of a nodding laser (.nod) to an LCM event log")
      ->callback([&arguments] {
        arguments.work = [&] { convert::import_nod(arguments.in, arguments.out); };
      });
  CLI::App* uos = add_import(app, arguments, "uos",
                             "Folder of 3DTK scans (scanNNN.3d, .pose) to an LCM event log");
  uos->add_option("--start", arguments.range.first, "Number of the first scan");
  uos->add_option("--end", arguments.range.last, "Number of the last scan");
  uos->callback([&arguments] {
    arguments.work = [&] { convert::import_uos(arguments.in, arguments.out, arguments.range); };
  });
}

void print_info(const Arguments& arguments) {
  convert::print(std::cout, convert::summarize_log(arguments.in));
}

void export_log(const Arguments& arguments) {
  const std::string ending = std::filesystem::path(arguments.out).extension();
  const auto channel_or = [&arguments](const char* usual) {
    return arguments.channel.empty() ? usual : arguments.channel;
  };
  if (ending == ".clf") {
    convert::export_carmen(arguments.in, arguments.out);
  } else if (ending == ".csv") {
    convert::export_csv(arguments.in, arguments.out, channel_or("SCAN"));
  } else if (ending == ".ply" || ending == ".pcd") {
    using Format = nodmap::formats::CloudFormat;
    convert::export_cloud(arguments.in, arguments.out,
                          ending == ".ply" ? Format::kPly : Format::kPcd, arguments.window);
  } else {
    convert::export_tum(arguments.in, arguments.out, channel_or("ODOMETRY"));
  }
}

void add_exports(CLI::App& app, Arguments& arguments) {
  add_command(app, arguments, "info", "Show the content of an LCM event log")
      ->callback([&arguments] { arguments.work = [&] { print_info(arguments); }; });
  CLI::App* mcap = add_command(app, arguments, "mcap",
                               "LCM event log to MCAP, with the schemas of nodmap-viewer");
  mcap->add_option("OUT", arguments.out, "File to write; never overwritten")->required();
  mcap->callback([&arguments] {
    arguments.work = [&] { convert::export_mcap(arguments.in, arguments.out); };
  });
  CLI::App* uos = add_command(app, arguments, "uos-export",
                              "Saved 3D map (keyframes.lcmlog) to a folder of 3DTK scans");
  uos->add_option("OUT", arguments.out, "Folder to make")->required();
  uos->callback(
      [&arguments] { arguments.work = [&] { convert::export_uos(arguments.in, arguments.out); }; });
  CLI::App* command = add_command(app, arguments, "export",
                                  "LCM event log to CARMEN, CSV, a TUM trajectory or a cloud");
  command
      ->add_option("OUT", arguments.out,
                   "File to write, .clf, .csv, .tum, .ply or .pcd; never overwritten")
      ->required()
      ->check([](const std::string& out) {
        const std::string ending = std::filesystem::path(out).extension();
        const bool is_known = ending == ".clf" || ending == ".csv" || ending == ".tum" ||
                              ending == ".ply" || ending == ".pcd";
        return is_known ? std::string()
                        : "'" + out + "' does not end in .clf, .csv, .tum, .ply or .pcd";
      });
  auto* channel = command->add_option(
      "--channel", arguments.channel,
      "Channel to export; default: SCAN for .csv, ODOMETRY for .tum; others use both");
  auto* start = command
                    ->add_option("--start-s", arguments.window.start_s,
                                 "Cloud: seconds from the log's first scan to the cloud's")
                    ->check(nodmap::node::at_least_zero())
                    ->capture_default_str();
  auto* scans = command
                    ->add_option("--scans", arguments.window.num_scans,
                                 "Cloud: consecutive scans in the cloud")
                    ->check(nodmap::node::above_zero())
                    ->capture_default_str();
  command->callback([&arguments, channel, start, scans] {
    const std::string ending = std::filesystem::path(arguments.out).extension();
    for (const CLI::Option* option : {channel, start, scans}) {
      const bool is_for_cloud = option != channel;
      const bool is_used = is_for_cloud ? ending == ".ply" || ending == ".pcd"
                                        : ending == ".csv" || ending == ".tum";
      if (option->count() > 0 && !is_used) {
        throw CLI::ValidationError(option->get_name(), "has no effect on a " + ending + " file");
      }
    }
    arguments.work = [&] { export_log(arguments); };
  });
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  return nodmap::node::run_program(argc, argv,
                                   {.name = "nodmap-convert",
                                    .summary = "Converts recordings to and from LCM event logs.",
                                    .add_options =
                                        [&arguments](CLI::App& app) {
                                          app.require_subcommand(1);
                                          add_imports(app, arguments);
                                          add_exports(app, arguments);
                                        },
                                    .run =
                                        [&arguments](const std::string& /*lcm_url*/) {
                                          arguments.work();
                                          return 0;
                                        }});
}
