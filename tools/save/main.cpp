// SPDX-License-Identifier: BSD-3-Clause
// nodmap-save: asks 2D SLAM and 6D SLAM to write their maps now.
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/bus/live_bus.hpp"
#include "common/node/command_line.hpp"
#include "common/params/params.hpp"
#include "common/time/clock.hpp"
#include "nodmap/save_request_t.hpp"

namespace {

/// This program has none, but the options every process has.
struct SaveParams {
  template <class Visitor>
  void describe(Visitor& /*v*/) {}
};

int run(int argc, char** argv) {
  using namespace nodmap;
  SaveParams params;
  params::Table table(params);
  node::CommonOptions options;
  std::string requested_by = "nodmap-save";
  CLI::App app("Asks 2D SLAM and 6D SLAM to write their maps now.", "nodmap-save");
  node::add_common_options(app, options, table);
  app.add_option("--by", requested_by, "Who asks, for the log")->capture_default_str();
  if (const auto code = node::parse_command_line(app, argc, argv)) {
    return *code;
  }
  if (const auto code = node::apply_common_options("nodmap-save", options, table)) {
    return *code;
  }
  bus::LiveBus bus(options.lcm_url);
  save_request_t request{};
  request.utime = time::SystemClock().now_utime_us();
  request.requested_by = requested_by;
  bus.publish("SAVE_REQUEST", request);
  return bus.counts().not_published == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "nodmap-save: " << error.what() << "\n";
    return 1;
  }
}
