// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "common/formats/tum.hpp"
#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "tools/evaluate/relations.hpp"
#include "tools/evaluate/trajectory_error.hpp"

namespace {

namespace evaluate = nodmap::evaluate;
using nodmap::geometry::rad_to_deg;

struct Arguments {
  std::string trajectory;
  std::string truth;
  bool align = false;
  double tolerance_s = 0.05;
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

void print_trajectory(const Arguments& arguments) {
  const auto estimate = nodmap::formats::read_tum(arguments.trajectory);
  const auto tolerance_us = static_cast<std::int64_t>(std::llround(arguments.tolerance_s * 1e6));
  const auto pairs =
      evaluate::associate(estimate, nodmap::formats::read_tum(arguments.truth), tolerance_us);
  if (pairs.empty()) {
    throw std::runtime_error(arguments.trajectory + ": none of its " +
                             std::to_string(estimate.size()) + " poses has a true one at its time");
  }
  const auto errors =
      evaluate::measure_trajectory(pairs, arguments.align ? evaluate::Alignment::kLeastSquares
                                                          : evaluate::Alignment::kFirstPose);
  nlohmann::ordered_json result = {{"n", errors.n},
                                   {"missing", estimate.size() - errors.n},
                                   {"ate_rmse_m", errors.ate_rmse_m},
                                   {"ate_max_m", errors.ate_max_m},
                                   {"rot_rmse_deg", rad_to_deg(errors.rot_rmse_rad)},
                                   {"drift_percent", nullptr}};
  if (errors.drift_percent) {
    result["drift_percent"] = *errors.drift_percent;
  }
  std::cout << result.dump(2) << "\n";
}

void add_commands(CLI::App& app, Arguments& arguments) {
  CLI::App* relations =
      app.add_subcommand("relations", "Error of relative poses (Kuemmerle et al. 2009), as JSON");
  relations->add_option("TRAJECTORY", arguments.trajectory, "Estimate (.tum)")->required();
  relations->add_option("RELATIONS", arguments.truth, "Known relations (.relations)")->required();
  relations->callback([&arguments] { print_relations(arguments); });

  CLI::App* trajectory =
      app.add_subcommand("trajectory", "Error against a true trajectory, as JSON");
  trajectory->add_option("ESTIMATE", arguments.trajectory, "Estimate (.tum)")->required();
  trajectory->add_option("TRUTH", arguments.truth, "Truth (.tum)")->required();
  trajectory->add_flag("--align", arguments.align,
                       "Align all positions by least squares instead of the first pose");
  trajectory
      ->add_option("--tolerance-s", arguments.tolerance_s,
                   "A pose counts when a true one is this close in time")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  trajectory->callback([&arguments] { print_trajectory(arguments); });
}

int run(int argc, char** argv) {
  CLI::App app("Measures results against the truth.", "nodmap-evaluate");
  app.set_version_flag("--version", NODMAP_VERSION);
  app.require_subcommand(1);
  Arguments arguments;
  add_commands(app, arguments);
  nodmap::log::start("nodmap-evaluate", "info");
  return nodmap::node::parse_command_line(app, argc, argv).value_or(0);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodmap-evaluate: %s\n", error.what());
  } catch (...) {
    std::fputs("nodmap-evaluate: failed for an unknown reason\n", stderr);
  }
  return 1;
}
