// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <csignal>
#include <string>

#include "common/node/program.hpp"
#include "common/params/params.hpp"
#include "modules/viewer/live.hpp"
#include "modules/viewer/options.hpp"
#include "modules/viewer/params.hpp"
#include "modules/viewer/replay.hpp"

namespace nodmap::viewer {
namespace {

void add_options(CLI::App& app, Options& options) {
  app.add_option("--bind", options.bind, "Address to listen on")->capture_default_str();
  app.add_option("--port", options.port,
                 "Port for the page and the WebSocket; 0 selects a free one")
      ->capture_default_str();
  auto* control = app.add_flag(
      "--control", options.control,
      "Allow clients with the printed token to set goals, stop the robot and save maps");
  app.add_option("--procman", options.procman,
                 "Allow them also to start and stop the processes of this configuration (.pmd)")
      ->needs(control);
  app.add_option(
         "--replay", options.replay,
         "Play this LCM event log instead of receiving from LCM; several are merged by time")
      ->excludes(control);
}

int run(int argc, char** argv) {
  Options options;
  ViewerParams params;
  params::Table table(params);
  return node::run_program(
      argc, argv,
      {.name = kProgram,
       .summary = "Shows the robot live in the browser, and in viewers of Foxglove's protocol.",
       .params = &table,
       .uses_lcm = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .run =
           [&](const std::string& lcm_url) {
             options.lcm_url = lcm_url;
             // A client that disconnects while data are sent to it must not end the process.
             std::signal(SIGPIPE, SIG_IGN);
             options.replay.empty() ? run_live(options, params) : run_replay(options, params);
             return 0;
           }});
}

}  // namespace
}  // namespace nodmap::viewer

int main(int argc, char** argv) {
  return nodmap::viewer::run(argc, argv);
}
