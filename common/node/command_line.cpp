// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include "common/log/log.hpp"

namespace nodmap::node {
namespace {

std::string flag_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

}  // namespace

void add_common_options(CLI::App& app, CommonOptions& options, const params::Table& table) {
  app.set_version_flag("--version", NODMAP_VERSION);
  app.add_option("--lcm-url", options.lcm_url,
                 "LCM provider; else $LCM_DEFAULT_URL, else udpm://239.255.76.67:7667?ttl=0");
  app.add_option("--config", options.configs,
                 "YAML file with parameters that differ from the defaults; may be repeated")
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--set", options.assignments, "key=value: one parameter; may be repeated")
      ->allow_extra_args(false)
      ->take_all();
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error or off")
      ->capture_default_str();
  app.add_flag("--dump-params", options.dump_params,
               "Print the effective parameters as YAML, with what they mean, and end");
  app.add_flag("--params-markdown", options.params_markdown,
               "Print the parameters as a Markdown table, and end");
  for (const params::Entry& entry : table.entries()) {
    if (entry.kind == params::Kind::kFlag) {
      app.add_flag_callback(
          flag_name(entry.name),
          [&options, name = entry.name] { options.flags_given.push_back(name); }, entry.help);
    }
  }
}

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    std::cerr << app.get_name() << ": " << error.what() << " (--help tells more)\n";
    return 2;
  }
  return std::nullopt;
}

std::optional<int> apply_common_options(const std::string& program, const CommonOptions& options,
                                        params::Table& table) {
  try {
    for (const std::string& config : options.configs) {
      table.load_yaml(config);
    }
    for (const std::string& assignment : options.assignments) {
      table.set_assignment(assignment);
    }
    for (const std::string& name : options.flags_given) {
      table.set(name, "true", flag_name(name));
    }
    log::start(program, options.log_level);
  } catch (const std::exception& error) {
    std::cerr << program << ": " << error.what() << "\n";
    return 2;
  }
  if (options.dump_params) {
    std::cout << table.to_yaml();
    return 0;
  }
  if (options.params_markdown) {
    std::cout << table.to_markdown();
    return 0;
  }
  return std::nullopt;
}

void make_result_dir(const std::filesystem::path& dir) {
  std::filesystem::create_directories(dir);
  if (!std::filesystem::is_empty(dir)) {
    throw std::runtime_error(
        dir.string() + " is not empty, and results are never overwritten; name another --out");
  }
}

std::filesystem::path make_next_result_dir(const std::filesystem::path& dir) {
  namespace fs = std::filesystem;
  if (dir.empty()) {
    return {};
  }
  const fs::path first = dir.has_filename() ? dir : dir.parent_path();  // "DIR/" is DIR
  fs::path next = first;
  for (int number = 2; fs::exists(next) && !fs::is_empty(next); ++number) {
    next = first.string() + "." + std::to_string(number);
  }
  make_result_dir(next);
  return next;
}

}  // namespace nodmap::node
