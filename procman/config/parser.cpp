// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/parser.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "procman/config/check.hpp"
#include "procman/config/lexer.hpp"

namespace nodmap::procman {
namespace {

// Deeper than any sensible file; a recursion that input can drive needs an end.
constexpr int kMaxGroupDepth = 64;
constexpr int kMaxSignal = 64;          // SIGRTMAX on Linux
constexpr int kMaxSeconds = 24 * 3600;  // a longer grace time than a day is a slip of the pen
constexpr int kMaxWaitMs = 24 * 3600 * 1000;

/// Only "true" and "yes" do, in any case.
bool says_yes(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return word == "true" || word == "yes";
}

class Parser {
 public:
  explicit Parser(std::string_view text) : lexer_(text) { advance(); }

  Config parse() {
    while (token_.kind != TokenKind::kEnd) {
      const std::string word = expect_word({"cmd", "group", "script"});
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
  void parse_script();
  Action parse_action();
  Order parse_order(Verb verb);
  std::variant<Order, WaitTime, WaitStatus, RunScript> parse_wait();

  void advance() { token_ = lexer_.next(); }
  [[nodiscard]] bool closes() const {
    return token_.kind == TokenKind::kClose && !token_.is_extension;
  }
  [[noreturn]] void fail(const std::string& text) const { throw SyntaxError(token_.place, text); }
  [[nodiscard]] std::string found() const;
  std::string expect(TokenKind kind, const char* what);
  std::string expect_word(std::initializer_list<const char*> words);
  int expect_integer(int min, int max);
  Wanted expect_status();
  Target expect_named_target(const std::string& kind);
  std::string free_id();

  Lexer lexer_;
  Token token_;
  bool in_rule_ = false;
  Config config_;
};

std::string Parser::found() const {
  return token_.kind == TokenKind::kEnd ? "the end of the file" : "'" + token_.text + "'";
}

std::string Parser::expect(TokenKind kind, const char* what) {
  // What stands in a comment must not matter to those who skip it.
  if (token_.kind != kind || token_.is_extension != in_rule_) {
    fail(std::string("expected ") + what + ", found " + found());
  }
  std::string text = token_.text;
  advance();
  return text;
}

std::string Parser::expect_word(std::initializer_list<const char*> words) {
  const bool fits = token_.kind == TokenKind::kIdentifier &&
                    std::find(words.begin(), words.end(), token_.text) != words.end();
  if (!fits) {
    std::string list;
    for (const char* word : words) {
      list += list.empty() ? "" : ", ";
      list += word;
    }
    fail("expected " + list + ", found " + found());
  }
  return expect(TokenKind::kIdentifier, "a word");
}

int Parser::expect_integer(int min, int max) {
  const Place place = token_.place;
  const std::string text = expect(TokenKind::kInteger, "an integer");
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < min || value > max) {
    throw SyntaxError(
        place, text + " is not within " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

Wanted Parser::expect_status() {
  const Place place = token_.place;
  const std::string text = expect(TokenKind::kString, R"("running" or "stopped")");
  if (text != "running" && text != "stopped") {
    throw SyntaxError(place, R"(expected "running" or "stopped", found ")" + text + "\"");
  }
  return text == "running" ? Wanted::kRunning : Wanted::kStopped;
}

Target Parser::expect_named_target(const std::string& kind) {
  return {kind == "cmd" ? TargetKind::kCommand : TargetKind::kGroup,
          expect(TokenKind::kString, "a name in quotes")};
}

void Parser::parse_group(const std::string& outer, int depth) {
  const Place place = token_.place;
  const std::string name = expect(TokenKind::kString, "the group's name in quotes");
  if (name.find('/') != std::string::npos ||
      name.find_first_not_of(" \t\n\v\f\r") == std::string::npos) {
    throw SyntaxError(place, "a group's name must not be blank and not hold '/'");
  }
  if (depth > kMaxGroupDepth) {
    throw SyntaxError(place, "groups are nested too deeply");
  }
  const std::string path = outer.empty() ? name : outer + "/" + name;
  if (!config_.has_group(path)) {  // the same name twice is one group
    config_.groups.push_back(path);
  }
  expect(TokenKind::kOpen, "'{'");
  while (!closes()) {
    if (expect_word({"cmd", "group"}) == "cmd") {
      parse_command(path);
    } else {
      parse_group(path, depth + 1);
    }
  }
  advance();
}

/// A name for a command without one, the same in each reading of the same file.
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
  command.place = token_.place;
  if (token_.kind == TokenKind::kString) {
    command.id = token_.text;
    advance();
  }
  if (command.id.find('/') != std::string::npos) {
    throw SyntaxError(command.place, "a command's name must not hold '/'");
  }
  if (command.id.empty()) {
    command.id = free_id();
  }
  if (const Command* other = config_.find_command(command.id)) {
    throw SyntaxError(command.place, "there is a command \"" + command.id + "\" in line " +
                                         std::to_string(other->place.line) + " already");
  }
  expect(TokenKind::kOpen, "'{'");
  while (!closes()) {
    token_.is_extension ? parse_rule(command) : parse_attribute(command);
  }
  if (command.exec.find_first_not_of(" \t\n\v\f\r") == std::string::npos) {
    fail("the command \"" + command.id + "\" has no exec");
  }
  advance();
  if (!group.empty()) {
    command.group = group;
  } else if (!command.group.empty() && !config_.has_group(command.group)) {
    config_.groups.push_back(command.group);
  }
  config_.commands.push_back(std::move(command));
}

void Parser::parse_attribute(Command& command) {
  const Place place = token_.place;
  const std::string name = expect(TokenKind::kIdentifier, "an attribute or '}'");
  const auto value = [this] {
    expect(TokenKind::kAssign, "'='");
    return expect(TokenKind::kString, "a text in quotes");
  };
  const auto number = [this](int max) {
    expect(TokenKind::kAssign, "'='");
    return expect_integer(1, max);
  };
  if (name == "exec") {
    command.exec = value();
  } else if (name == "host" || name == "deputy") {
    command.deputy = value();
  } else if (name == "group") {
    command.group = normalized_group(value());
  } else if (name == "auto_respawn") {
    command.auto_respawn = says_yes(value());
  } else if (name == "stop_signal") {
    command.stop_signal = number(kMaxSignal);
  } else if (name == "stop_time_allowed") {
    command.stop_time_allowed_s = number(kMaxSeconds);
  } else {
    throw SyntaxError(place, "unrecognized attribute " + name);
  }
  expect(TokenKind::kSemicolon, "';'");
}

void Parser::parse_rule(Command& command) {
  in_rule_ = true;
  const Place place = token_.place;
  const std::string name = expect(TokenKind::kIdentifier, "a rule");
  expect(TokenKind::kAssign, "'='");
  if (name == "status_name") {
    command.health.status_name = expect(TokenKind::kString, "a text in quotes");
  } else if (name == "restart_silent_s") {
    command.health.restart_silent_s = expect_integer(2, kMaxSeconds);
  } else if (name == "restart_failed_s") {
    command.health.restart_failed_s = expect_integer(1, kMaxSeconds);
  } else {
    throw SyntaxError(
        place, "unrecognized rule " + name + " (status_name, restart_silent_s, restart_failed_s)");
  }
  expect(TokenKind::kSemicolon, "';'");
  in_rule_ = false;
}

void Parser::parse_script() {
  Script script;
  script.place = token_.place;
  script.name = expect(TokenKind::kString, "the script's name in quotes");
  if (config_.find_script(script.name) != nullptr) {
    throw SyntaxError(script.place, "there is a script \"" + script.name + "\" already");
  }
  expect(TokenKind::kOpen, "'{'");
  while (!closes()) {
    script.actions.push_back(parse_action());
  }
  advance();
  config_.scripts.push_back(std::move(script));
}

Action Parser::parse_action() {
  Action action;
  action.place = token_.place;
  const std::string word = expect_word({"start", "stop", "restart", "wait", "run_script"});
  if (word == "wait") {
    action.what = parse_wait();
  } else if (word == "run_script") {
    action.what = RunScript{expect(TokenKind::kString, "the script's name in quotes")};
  } else {
    action.what = parse_order(word == "start"  ? Verb::kStart
                              : word == "stop" ? Verb::kStop
                                               : Verb::kRestart);
  }
  expect(TokenKind::kSemicolon, "';'");
  return action;
}

Order Parser::parse_order(Verb verb) {
  Order order;
  order.verb = verb;
  const std::string kind = expect_word({"everything", "cmd", "group"});
  if (kind != "everything") {
    order.target = expect_named_target(kind);
  }
  if (token_.kind == TokenKind::kIdentifier) {
    expect_word({"wait"});
    order.wait = expect_status();
  }
  return order;
}

std::variant<Order, WaitTime, WaitStatus, RunScript> Parser::parse_wait() {
  const std::string kind = expect_word({"ms", "cmd", "group"});
  if (kind == "ms") {
    return WaitTime{expect_integer(0, kMaxWaitMs)};
  }
  WaitStatus wait;
  wait.target = expect_named_target(kind);
  expect_word({"status"});
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
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  ParsedConfig parsed = parse_config(text);
  std::string errors;
  for (const ConfigError& error : parsed.errors) {
    if (!errors.empty()) {
      errors += '\n';
    }
    errors += describe(file.string(), error);
  }
  if (!errors.empty()) {
    throw std::runtime_error(errors);
  }
  return std::move(parsed.config);
}

}  // namespace nodmap::procman
