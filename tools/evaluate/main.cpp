// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/formats/tum.hpp"
#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "tools/evaluate/relations.hpp"

namespace {

namespace evaluate = nodmap::evaluate;
using nodmap::geometry::rad_to_deg;

struct Arguments {
  std::string trajectory;
  std::string truth;
};

void print_relations(const Arguments& arguments) {
  const auto errors = evaluate::measure_relations(nodmap::formats::read_tum(arguments.trajectory),
                                                  evaluate::read_relations(arguments.truth));
  if (errors.n == 0) {
    throw std::runtime_error(arguments.trajectory + ": holds both stamps of none of the " +
                             std::to_string(errors.missing) + " relations");
  }
  const nlohmann::ordered_json result = {{"n", errors.n},
                                         {"missing", errors.missing},
                                         {"trans_mean_m", errors.trans_mean_m},
                                         {"trans_std_m", errors.trans_std_m},
                                         {"trans_max_m", errors.trans_max_m},
                                         {"rot_mean_deg", rad_to_deg(errors.rot_mean_rad)},
                                         {"rot_std_deg", rad_to_deg(errors.rot_std_rad)}};
  std::cout << result.dump(2) << "\n";
}

void add_commands(CLI::App& app, Arguments& arguments) {
  CLI::App* relations =
      app.add_subcommand("relations", "Error of relative poses (Kuemmerle et al. 2009), as JSON");
  relations->add_option("TRAJECTORY", arguments.trajectory, "Estimate (.tum)")->required();
  relations->add_option("RELATIONS", arguments.truth, "Known relations (.relations)")->required();
  relations->callback([&arguments] { print_relations(arguments); });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures results against the truth.", "nodmap-evaluate");
  app.set_version_flag("--version", NODMAP_VERSION);
  app.require_subcommand(1);
  Arguments arguments;
  add_commands(app, arguments);
  nodmap::log::start("nodmap-evaluate", "info");
  try {
    return nodmap::node::parse_command_line(app, argc, argv).value_or(0);
  } catch (const std::exception& error) {
    nodmap::log::get().error("{}", error.what());
    return 1;
  }
}
