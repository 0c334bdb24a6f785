// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <iostream>
#include <set>
#include <stdexcept>

#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "procman/config/parser.hpp"
#include "procman/deputy/deputy.hpp"
#include "procman/protocol/host.hpp"

namespace nodmap::procman {
namespace {

constexpr const char* kProgram = "nodmap-deputy";

struct Options {
  std::string config;
  std::string id;
  bool trust_network = false;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("CONFIG,--config", options.config,
                 "Configuration (.pmd) with the commands that this deputy may run");
  app.add_option("-i,--id", options.id,
                 "Name of this deputy; default: the only one in CONFIG, else the host's name");
  app.add_flag(
      "--trust-network", options.trust_network,
      "Run any command that arrives on the network, as the existing deputy does. LCM does not "
      "authenticate senders: anyone on the network can then use this account");
}

std::string deputy_id(const Options& options, const Config& config) {
  if (!options.id.empty()) {
    return options.id;
  }
  std::set<std::string> named;
  for (const Command& command : config.commands) {
    named.insert(command.deputy);
  }
  return named.size() == 1 ? *named.begin() : host_name();
}

DeputySettings settings_of(const Options& options) {
  if (options.config.empty() && !options.trust_network) {
    throw node::UsageError(
        "the permitted commands are required: nodmap-deputy CONFIG.pmd (or --trust-network; see "
        "--help)");
  }
  const Config config = options.config.empty() ? Config{} : load_config(options.config);
  DeputySettings settings;
  settings.id = deputy_id(options, config);
  if (options.trust_network) {
    settings.permissions = Permissions::everything();
    settings.trusts_orders = true;
    return settings;
  }
  settings.config_file = options.config;
  settings.permissions = Permissions(settings.id, config);
  if (settings.permissions.is_empty()) {
    throw node::UsageError(options.config + " has no command for the deputy " + settings.id +
                           " (--id)");
  }
  return settings;
}

int run(int argc, char** argv) {
  Options options;
  DeputySettings settings;
  return node::run_program(
      argc, argv,
      {.name = kProgram,
       .summary =
           "Starts, watches and stops the processes of this host on the orders of a sheriff.",
       .uses_lcm = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .check = [&] { settings = settings_of(options); },
       .run =
           [&settings](const std::string& lcm_url) {
             settings.lcm_url = lcm_url;
             return run_deputy(settings);
           }});
}

}  // namespace
}  // namespace nodmap::procman

int main(int argc, char** argv) {
  return nodmap::procman::run(argc, argv);
}
