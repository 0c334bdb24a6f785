// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "common/formats/input_file.hpp"
#include "common/node/log.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "common/params/suggestion.hpp"
#include "procman/config/parser.hpp"
#include "procman/sheriff/lone_deputies.hpp"
#include "procman/sheriff/tasks.hpp"
#include "procman/sheriff/terminal.hpp"
#include "procman/sheriff/watch.hpp"

namespace nodmap::procman {
namespace {

constexpr const char* kProgram = "nodmap-sheriff";

struct Options {
  std::string config;
  std::string lcm_url;
  std::string script;
  std::string after_script;
  std::optional<double> timeout_s;
  bool check = false;
  bool status = false;
  bool json = false;
  bool observe = false;
  bool lone = false;
  std::string start;
  std::string stop;
  std::string restart;
  std::string output;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("CONFIG", options.config, "Configuration (.pmd)")->required();
  auto* script = app.add_option("--script", options.script, "Run this script of the configuration");
  app.add_option("--on-script-complete", options.after_script,
                 "exit (the default where stdout is no terminal), stay (the default on one) or "
                 "observe")
      ->check(CLI::IsMember({"exit", "stay", "observe"}))
      ->needs(script);
  app.add_option("--timeout", options.timeout_s,
                 "Exit with code 1 if the script takes longer, seconds")
      ->check(node::above_zero())
      ->needs(script);
  auto* what = app.add_option_group("instead of a script");
  what->add_flag("--check", options.check,
                 "Check the configuration: print its contents or its errors");
  auto* status = what->add_flag("--status", options.status, "Print the state of all commands");
  auto* start = what->add_option("--start", options.start, "Start a command or group, and exit");
  auto* stop = what->add_option("--stop", options.stop, "Stop a command or group, and exit");
  auto* restart =
      what->add_option("--restart", options.restart, "Restart a command or group, and exit");
  what->add_option("--output", options.output,
                   "Print the last output of a command, and what follows until a signal");
  what->require_option(0, 1);
  what->excludes(script);
  app.add_flag("--json", options.json, "Print --status as JSON")->needs(status);
  app.add_flag("-o,--observe", options.observe, "Only observe; give no orders")
      ->excludes(script)
      ->excludes(start)
      ->excludes(stop)
      ->excludes(restart);
  auto* lone =
      app.add_flag(
             "--lone", options.lone,
             "Also run the deputies of the configuration, on this host; stop everything at the end")
          ->excludes("--observe");
  what->excludes(lone);
  app.footer(
      "Exit codes: 0 done, 1 not reached or a host does not answer, 2 wrong command line or "
      "configuration, 3 another sheriff gives orders.");
}

// The configuration; empty if it has errors, which have been printed. Throws
// formats::InputFileError.
std::optional<Config> read_config(const std::string& file) {
  ParsedConfig parsed = parse_config(formats::read_input(file));
  for (const ConfigError& error : parsed.errors) {
    std::cerr << describe(file, error) << "\n";
  }
  return parsed.errors.empty() ? std::optional(std::move(parsed.config)) : std::nullopt;
}

AfterScript after_script(const std::string& word) {
  if (word.empty()) {
    return Terminal::is_there() ? AfterScript::kStay : AfterScript::kExit;
  }
  return word == "exit"   ? AfterScript::kExit
         : word == "stay" ? AfterScript::kStay
                          : AfterScript::kObserve;
}

// The script of the options, or null. Throws node::UsageError.
const Script* find_script(const Options& options, const Config& config) {
  if (options.script.empty()) {
    return nullptr;
  }
  const Script* found = config.find_script(options.script);
  if (found == nullptr) {
    std::vector<std::string> names;
    for (const Script& script : config.scripts) {
      names.push_back(script.name);
    }
    throw node::UsageError(options.config + " has no script \"" + options.script + "\"" +
                           params::did_you_mean(options.script, names));
  }
  return found;
}

int serve(const Options& options, const Config& config) {
  WatchOptions watching;
  watching.script = find_script(options, config);
  if (watching.script != nullptr) {
    watching.after_script = after_script(options.after_script);
    watching.timeout_s = options.timeout_s;
  }
  watching.observe = options.observe;
  watching.config_file = options.config;
  Sheriff sheriff(config, options.lcm_url);
  if (options.status) {
    return print_status(sheriff, options.json);
  }
  if (!options.output.empty()) {
    return follow_output(sheriff, options.output);
  }
  if (!options.start.empty()) {
    return change(sheriff, Verb::kStart, options.start);
  }
  if (!options.stop.empty()) {
    return change(sheriff, Verb::kStop, options.stop);
  }
  if (!options.restart.empty()) {
    return change(sheriff, Verb::kRestart, options.restart);
  }
  return watch(sheriff, watching);
}

// The same with --lone: runs the deputies as well.
int serve_alone(const Options& options, const Config& config) {
  find_script(options, config);  // before anything is started
  LoneDeputies deputies(options.config, config, options.lcm_url);
  const int code = serve(options, config);
  return deputies.stop() || code != exit_code::kDone ? code : exit_code::kFailed;
}

int run(int argc, char** argv) {
  Options options;
  return node::run_program(
      argc, argv,
      {.name = kProgram,
       .summary =
           "Tells the deputies which commands to run, from a configuration, and shows their state.",
       .uses_lcm = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .run = [&options](const std::string& lcm_url) -> int {
         options.lcm_url = lcm_url;
         const std::optional<Config> config = read_config(options.config);
         if (!config) {
           return exit_code::kWrong;
         }
         if (options.check) {
           return print_config(options.config, *config);
         }
         return options.lone ? serve_alone(options, *config) : serve(options, *config);
       }});
}

}  // namespace
}  // namespace nodmap::procman

int main(int argc, char** argv) {
  return nodmap::procman::run(argc, argv);
}
