// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string_view>
#include <system_error>

#include "common/formats/number.hpp"
#include "common/node/log.hpp"
#include "common/params/suggestion.hpp"

namespace nodmap::node {
namespace {

volatile std::sig_atomic_t g_stop = 0;  // NOLINT: a signal handler can reach nothing but a global

// The options that many programs have (docs/quickstart.md).
struct CommonOptions {
  std::string lcm_url;
  std::vector<std::string> configs;
  std::vector<std::string> assignments;
  std::vector<std::string> flags;  // flag parameters given as --name-with-dashes
  std::string log_level = "info";
  bool dump_params = false;
  bool params_markdown = false;
};

std::string flag_name(std::string name) {
  name.erase(
      0,
      name.rfind('.') + 1);  // only the last part of a nested name: map.save_ot becomes --save-ot
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

void add_param_options(CLI::App& app, CommonOptions& options, const params::Table& table) {
  app.add_option("--config", options.configs,
                 "YAML file with parameters that differ from the defaults; may be repeated")
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--set", options.assignments, "key=value: one parameter; may be repeated")
      ->allow_extra_args(false)
      ->take_all();
  app.add_flag("--dump-params", options.dump_params,
               "Print the effective parameters and their meanings as YAML, and exit");
  app.add_flag("--params-markdown", options.params_markdown,
               "Print the parameters as a Markdown table, and exit");
  for (const params::Entry& entry : table.entries()) {
    if (entry.kind == params::Kind::kFlag && entry.get() == "false") {
      app.add_flag_callback(
             flag_name(entry.name),
             [&options, name = entry.name] { options.flags.push_back(name); }, entry.help)
          ->disable_flag_override();  // else --name=false would be taken, and set nothing
    }
  }
}

void load_params(params::Table& table, const CommonOptions& options) {
  for (const std::string& config : options.configs) {
    table.load_yaml(config);
  }
  for (const std::string& assignment : options.assignments) {
    table.set_assignment(assignment);
  }
  for (const std::string& name : options.flags) {
    table.set(name, "true", flag_name(name));
  }
}

int complain(const std::string& program, const std::string& what) {
  std::cerr << program << ": " << what << "\n";
  return 2;
}

// The innermost subcommand that the user chose; the program itself if there is none.
const CLI::App& chosen_command(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    if (!command->get_name().empty()) {  // without a name it is a group of options
      return chosen_command(*command);
    }
  }
  return app;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  for (const CLI::App* group : app.get_subcommands(nullptr)) {
    if (group->get_name().empty()) {
      const std::vector<std::string> more = option_names(*group);
      names.insert(names.end(), more.begin(), more.end());
    }
  }
  return names;
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    if (!command->get_name().empty()) {
      names.push_back(command->get_name());
    }
  }
  return names;
}

// A value of the wrong type, of which CLI11 says "Could not convert: NAME = VALUE".
std::optional<std::string> explain_conversion(const std::string& what) {
  constexpr std::string_view kBegin = "Could not convert: ";
  constexpr std::string_view kEquals = " = ";
  const std::size_t equals = what.find(kEquals);
  if (!what.starts_with(kBegin) || equals == std::string::npos) {
    return std::nullopt;
  }
  return what.substr(kBegin.size(), equals - kBegin.size()) + ": '" +
         what.substr(equals + kEquals.size()) + "' is not a number that it can take";
}

// Describes what is wrong with the command line. Reports unknown options first: they are the cause
// when their values are left over as unexpected arguments.
std::string explain(const CLI::App& command, const CLI::ParseError& error) {
  const std::vector<std::string> unused = command.remaining();
  for (const std::string& word : unused) {
    if (word.size() > 1 && word.front() == '-') {
      const std::string name = word.substr(0, word.find('='));
      return "unknown option '" + name + "'" + params::did_you_mean(name, option_names(command));
    }
  }
  const std::vector<std::string> subcommands = subcommand_names(command);
  if (!subcommands.empty()) {
    std::string known;
    for (const std::string& name : subcommands) {
      known += (known.empty() ? "" : ", ") + name;
    }
    if (unused.empty()) {
      return "a subcommand is required: " + known;
    }
    const std::string suggestion = params::did_you_mean(unused.front(), subcommands);
    return "unknown subcommand '" + unused.front() + "'" +
           (suggestion.empty() ? "; known are: " + known : suggestion);
  }
  return unused.empty() ? explain_conversion(error.what()).value_or(error.what())
                        : "unexpected argument '" + unused.front() + "'";
}

// Why `text` cannot be the value of an option of this type, although CLI11 takes it; empty if it
// can.
std::string fault_of(const std::string& type, const std::string& text) {
  double number = 0.0;
  if (type.starts_with("FLOAT") && CLI::detail::lexical_cast(text, number) &&
      !std::isfinite(number)) {  // "nan" is a number for CLI11
    return "'" + text + "' is not a finite number";
  }
  if (type.starts_with("UINT") && !formats::parse_number<std::uint64_t>(text)) {
    return "'" + text + "' is not a whole number from 0 to 2^64 - 1";  // -1 wraps around
  }
  // It would pass for an option that is not given: a replay would become a live run.
  return type.starts_with("TEXT") && text.empty() ? "needs a value" : "";
}

void check_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& text : option->results()) {
      if (const std::string fault = fault_of(option->get_type_name(), text); !fault.empty()) {
        throw CLI::ValidationError(option->get_name(), fault);
      }
    }
  }
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    check_values(*command);
  }
}

int complain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = chosen_command(app);
  const std::string name =
      app.get_name() + (&command == &app ? std::string() : " " + command.get_name());
  return complain(name, explain(command, error) + " (see " + name + " --help)");
}

// Does everything that comes before the work. Returns an exit code if the program is to end now.
std::optional<int> prepare(CLI::App& app, int argc, char** argv, const Program& program,
                           CommonOptions& options) {
  try {
    app.parse(argc, argv);
    check_values(app);
    if (program.params != nullptr) {
      load_params(*program.params, options);
    }
    log::start(program.name, options.log_level);
    if (program.check && !options.dump_params && !options.params_markdown) {
      program.check();
    }
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    return complain(app, error);
  } catch (const std::exception& error) {
    return complain(program.name, error.what());
  }
  if (options.dump_params) {
    std::cout << program.params->to_yaml();
    return 0;
  }
  if (options.params_markdown) {
    std::cout << program.params->to_markdown();
    return 0;
  }
  return std::nullopt;
}

// The exit code of a program that would end with `code`: an error if what it has printed could not
// be written, as on a full disk, because half a result passes for a result.
int after_output(const std::string& program, int code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) {
    return code;
  }
  const std::string why = errno != 0 ? ": " + std::system_category().message(errno) : "";
  complain(program, "cannot write to stdout" + why);
  return code != 0 ? code : 1;
}

}  // namespace

int run_program(int argc, char** argv, const Program& program) {
  CommonOptions options;
  options.log_level = program.log_level;
  CLI::App app(program.summary, program.name);
  app.set_version_flag("--version", NODMAP_VERSION);
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error or off")
      ->capture_default_str();
  if (program.uses_lcm) {
    app.add_option("-u,--lcm-url", options.lcm_url,
                   "LCM provider; else $LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0");
  }
  if (program.params != nullptr) {
    add_param_options(app, options, *program.params);
  }
  if (program.add_options) {
    program.add_options(app);
  }
  if (const std::optional<int> code = prepare(app, argc, argv, program, options)) {
    return after_output(program.name, *code);
  }
  if (!program.is_killed_by_signals) {
    catch_stop_signals();
  }
  if (program.outlives_its_readers) {
    std::signal(SIGPIPE, SIG_IGN);
  }
  try {
    const int code = program.run(options.lcm_url);
    return program.outlives_its_readers ? code : after_output(program.name, code);
  } catch (const formats::UserError& error) {
    return complain(program.name, error.what());
  } catch (const std::exception& error) {
    log::get().error("{}", error.what());
    return 1;
  }
}

void catch_stop_signals() {
  g_stop = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = 1; };
  ::sigemptyset(&action.sa_mask);
  // Without SA_RESTART, so that a wait for messages ends at once.
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A terminal or ssh session that closes asks for the same, but not of a program under nohup.
  struct sigaction inherited {};
  ::sigaction(SIGHUP, nullptr, &inherited);
  if (inherited.sa_handler != SIG_IGN) {
    ::sigaction(SIGHUP, &action, nullptr);
  }
}

bool stop_requested() {
  return g_stop != 0;
}

}  // namespace nodmap::node
