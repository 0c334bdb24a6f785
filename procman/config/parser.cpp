// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/parser.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/formats/input_file.hpp"
#include "procman/config/lexer.hpp"

namespace nodmap::procman {
namespace {

// Limits the recursion; no sensible file is nested so deeply.
constexpr int kMaxGroupDepth = 64;
constexpr int kMaxSignal = 64;          // SIGRTMAX on Linux
constexpr int kMaxSeconds = 24 * 3600;  // more than a day is a mistake
constexpr int kMaxMegabytes = 1'000'000;
constexpr int kMaxCpu = 1023;  // the largest that fits into sched_setaffinity's cpu_set_t
constexpr int kMaxWaitMs = 24 * 3600 * 1000;

// What "true" or "yes", "false" or "no" say, in upper or lower case.
bool parse_bool(const std::string& text, Place place) {
  std::string word = text;
  std::ranges::transform(word, word.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  });
  if (word == "true" || word == "yes") {
    return true;
  }
  if (word == "false" || word == "no") {
    return false;
  }
  throw SyntaxError(place, "\"" + text + "\" is neither true nor false");
}

// Parses processors in the notation of `taskset`: "0,2-3".
std::vector<int> parse_cpus(const std::string& text, Place place) {
  const auto fail = [&] {
    return SyntaxError(place, "\"" + text + "\" is not a list of processors (example: 0,2-3)");
  };
  std::vector<int> cpus;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto number = [&] {
    int value = -1;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc() || value < 0 || value > kMaxCpu) {
      throw fail();
    }
    at = rest;
    return value;
  };
  while (true) {
    const int first = number();
    int last = first;
    if (at != end && *at == '-') {
      ++at;
      last = number();
    }
    if (last < first) {
      throw fail();
    }
    for (int cpu = first; cpu <= last; ++cpu) {
      cpus.push_back(cpu);
    }
    if (at == end) {
      return cpus;
    }
    if (*at++ != ',') {
      throw fail();
    }
  }
}

class Parser {
 public:
  explicit Parser(std::string_view text) : reader_(text) {}

  Config parse() {
    while (!reader_.at_end()) {
      const std::string word = reader_.expect_word({"cmd", "group", "script"});
      if (word == "cmd") {
        parse_command("");
      } else if (word == "group") {
        parse_group("", 1);
      } else {
        parse_script();
      }
    }
    return std::move(config_);
  }

 private:
  void parse_group(const std::string& outer, int depth);
  void parse_command(const std::string& group);
  void parse_attribute(Command& command);
  void parse_rule(Command& command);
  void need_new(const std::string& name, Place place);
  void parse_script();
  Action parse_action();
  Action parse_wait_for_health();
  Order parse_order(Verb verb);
  std::variant<Order, Pause, WaitFor, RunScript> parse_wait();

  Wanted expect_status();
  Target expect_named_target(const std::string& kind);
  std::string free_id();

  TokenReader reader_;
  Config config_;
  std::set<std::string> given_;  // attributes and rules of the present command so far
};

Wanted Parser::expect_status() {
  const Place place = reader_.token().place;
  const std::string text = reader_.expect(TokenKind::kString, R"("running" or "stopped")");
  if (text != "running" && text != "stopped") {
    throw SyntaxError(place, R"(expected "running" or "stopped", found ")" + text + "\"");
  }
  return text == "running" ? Wanted::kRunning : Wanted::kStopped;
}

Target Parser::expect_named_target(const std::string& kind) {
  return {kind == "cmd" ? TargetKind::kCommand : TargetKind::kGroup,
          reader_.expect(TokenKind::kString, "a name in quotes")};
}

void Parser::parse_group(const std::string& outer, int depth) {
  const Place place = reader_.token().place;
  const std::string name = reader_.expect(TokenKind::kString, "the group's name in quotes");
  if (name.find('/') != std::string::npos ||
      name.find_first_not_of(" \t\n\v\f\r") == std::string::npos) {
    throw SyntaxError(place, "a group's name must not be blank or contain '/'");
  }
  if (depth > kMaxGroupDepth) {
    throw SyntaxError(place, "groups are nested too deeply");
  }
  const std::string path = outer.empty() ? name : outer + "/" + name;
  if (!config_.has_group(path)) {  // groups with the same name are one group
    config_.groups.push_back(path);
  }
  reader_.expect(TokenKind::kOpen, "'{'");
  while (!reader_.closes()) {
    if (reader_.expect_word({"cmd", "group"}) == "cmd") {
      parse_command(path);
    } else {
      parse_group(path, depth + 1);
    }
  }
  reader_.advance();
}

// A name for an unnamed command; the same file always gives the same names.
std::string Parser::free_id() {
  std::string id;
  int number = 0;
  do {
    id = "unnamed-" + std::to_string(++number);
  } while (config_.find_command(id) != nullptr);
  return id;
}

void Parser::parse_command(const std::string& group) {
  Command command;
  command.place = reader_.token().place;
  if (reader_.token().kind == TokenKind::kString) {
    command.id = reader_.token().text;
    reader_.advance();
  }
  if (command.id.find('/') != std::string::npos) {
    throw SyntaxError(command.place, "a command's name must not contain '/'");
  }
  if (command.id.empty()) {
    command.id = free_id();
  }
  if (const Command* other = config_.find_command(command.id)) {
    throw SyntaxError(command.place, "there is a command \"" + command.id + "\" in line " +
                                         std::to_string(other->place.line) + " already");
  }
  reader_.expect(TokenKind::kOpen, "'{'");
  given_.clear();
  while (!reader_.closes()) {
    reader_.token().is_extension ? parse_rule(command) : parse_attribute(command);
  }
  if (command.exec.find_first_not_of(" \t\n\v\f\r") == std::string::npos) {
    reader_.fail("the command \"" + command.id + "\" has no exec");
  }
  reader_.advance();
  if (!group.empty()) {
    command.group = group;
  } else if (!command.group.empty() && !config_.has_group(command.group)) {
    config_.groups.push_back(command.group);
  }
  config_.commands.push_back(std::move(command));
}

// Throws if the command has this attribute or rule already: one of the two would be a mistake.
void Parser::need_new(const std::string& name, Place place) {
  if (!given_.insert(name == "host" ? "deputy" : name).second) {
    throw SyntaxError(place, name + " is already set in this command");
  }
}

void Parser::parse_attribute(Command& command) {
  const Place place = reader_.token().place;
  const std::string name = reader_.expect(TokenKind::kIdentifier, "an attribute or '}'");
  need_new(name, place);
  Place value_place;
  const auto value = [&] {
    reader_.expect(TokenKind::kAssign, "'='");
    value_place = reader_.token().place;
    return reader_.expect(TokenKind::kString, "a text in quotes");
  };
  const auto number = [this](int max) {
    reader_.expect(TokenKind::kAssign, "'='");
    return reader_.expect_integer(1, max);
  };
  if (name == "exec") {
    command.exec = value();
  } else if (name == "host" || name == "deputy") {
    command.deputy = value();
  } else if (name == "group") {
    command.group = normalized_group(value());
  } else if (name == "auto_respawn") {
    const std::string text = value();
    command.auto_respawn = parse_bool(text, value_place);
  } else if (name == "stop_signal") {
    command.stop_signal = number(kMaxSignal);
  } else if (name == "stop_time_allowed") {
    command.stop_time_allowed_s = number(kMaxSeconds);
  } else {
    throw SyntaxError(place, "unrecognized attribute " + name);
  }
  reader_.expect(TokenKind::kSemicolon, "';'");
}

void Parser::parse_rule(Command& command) {
  reader_.expect_extension(true);
  const Place place = reader_.token().place;
  const std::string name = reader_.expect(TokenKind::kIdentifier, "a rule");
  need_new(name, place);
  reader_.expect(TokenKind::kAssign, "'='");
  if (name == "status_name") {
    command.health.status_name = reader_.expect(TokenKind::kString, "a text in quotes");
  } else if (name == "restart_silent_s") {
    command.health.restart_silent_s = reader_.expect_integer(2, kMaxSeconds);
  } else if (name == "restart_failed_s") {
    command.health.restart_failed_s = reader_.expect_integer(1, kMaxSeconds);
  } else if (name == "restart_degraded_s") {
    command.health.restart_degraded_s = reader_.expect_integer(1, kMaxSeconds);
  } else if (name == "restart_mute_s") {
    command.health.restart_mute_s = reader_.expect_integer(2, kMaxSeconds);
  } else if (name == "nice") {
    command.resources.nice = reader_.expect_integer(1, 19);
  } else if (name == "realtime") {
    command.resources.realtime = reader_.expect_integer(1, 99);
  } else if (name == "memory_mb") {
    command.resources.memory_mb = reader_.expect_integer(1, kMaxMegabytes);
  } else if (name == "cpus") {
    const Place value_place = reader_.token().place;
    command.resources.cpus =
        parse_cpus(reader_.expect(TokenKind::kString, "a text in quotes"), value_place);
  } else {
    throw SyntaxError(place, "unrecognized rule " + name +
                                 " (status_name, restart_silent_s, "
                                 "restart_failed_s, restart_degraded_s, restart_mute_s, nice, "
                                 "realtime, memory_mb, cpus)");
  }
  reader_.expect(TokenKind::kSemicolon, "';'");
  reader_.expect_extension(false);
}

void Parser::parse_script() {
  Script script;
  script.place = reader_.token().place;
  script.name = reader_.expect(TokenKind::kString, "the script's name in quotes");
  if (config_.find_script(script.name) != nullptr) {
    throw SyntaxError(script.place, "there is a script \"" + script.name + "\" already");
  }
  reader_.expect(TokenKind::kOpen, "'{'");
  while (!reader_.closes()) {
    script.actions.push_back(reader_.token().is_extension ? parse_wait_for_health()
                                                          : parse_action());
  }
  reader_.advance();
  config_.scripts.push_back(std::move(script));
}

Action Parser::parse_action() {
  Action action;
  action.place = reader_.token().place;
  const std::string word = reader_.expect_word({"start", "stop", "restart", "wait", "run_script"});
  if (word == "wait") {
    action.what = parse_wait();
  } else if (word == "run_script") {
    action.what = RunScript{reader_.expect(TokenKind::kString, "the script's name in quotes")};
  } else {
    action.what = parse_order(word == "start"  ? Verb::kStart
                              : word == "stop" ? Verb::kStop
                                               : Verb::kRestart);
  }
  reader_.expect(TokenKind::kSemicolon, "';'");
  return action;
}

// An extension: the existing tools do not know STATUS, and skip it.
Action Parser::parse_wait_for_health() {
  reader_.expect_extension(true);
  Action action;
  action.place = reader_.token().place;
  reader_.expect_word({"wait"});
  WaitFor wait;
  wait.target = expect_named_target(reader_.expect_word({"cmd", "group"}));
  reader_.expect_word({"status"});
  const Place place = reader_.token().place;
  const std::string status = reader_.expect(TokenKind::kString, R"("healthy")");
  if (status != "healthy") {
    throw SyntaxError(place, R"(expected "healthy", found ")" + status + "\"");
  }
  wait.status = Wanted::kHealthy;
  action.what = wait;
  reader_.expect(TokenKind::kSemicolon, "';'");
  reader_.expect_extension(false);
  return action;
}

Order Parser::parse_order(Verb verb) {
  Order order;
  order.verb = verb;
  const std::string kind = reader_.expect_word({"everything", "cmd", "group"});
  if (kind != "everything") {
    order.target = expect_named_target(kind);
  }
  if (reader_.token().kind == TokenKind::kIdentifier) {
    reader_.expect_word({"wait"});
    order.wait = expect_status();
  }
  return order;
}

std::variant<Order, Pause, WaitFor, RunScript> Parser::parse_wait() {
  const std::string kind = reader_.expect_word({"ms", "cmd", "group"});
  if (kind == "ms") {
    return Pause{reader_.expect_integer(0, kMaxWaitMs)};
  }
  WaitFor wait;
  wait.target = expect_named_target(kind);
  reader_.expect_word({"status"});
  wait.status = expect_status();
  return wait;
}

}  // namespace

ParsedConfig parse_config(std::string_view text) {
  ParsedConfig parsed;
  try {
    parsed.config = Parser(text).parse();
  } catch (const SyntaxError& error) {
    parsed.errors.push_back({error.place(), error.what()});
    return parsed;
  }
  parsed.errors = check_scripts(parsed.config);
  return parsed;
}

std::string describe(const std::string& file, const ConfigError& error) {
  return file + ":" + std::to_string(error.place.line) + ":" + std::to_string(error.place.column) +
         ": " + error.text;
}

Config load_config(const std::filesystem::path& file) {
  ParsedConfig parsed = parse_config(formats::read_input(file));
  std::string errors;
  for (const ConfigError& error : parsed.errors) {
    if (!errors.empty()) {
      errors += '\n';
    }
    errors += describe(file.string(), error);
  }
  if (!errors.empty()) {
    throw formats::InputFileError(errors);
  }
  return std::move(parsed.config);
}

}  // namespace nodmap::procman
