// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/watch.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "procman/config/config_watch.hpp"
#include "procman/sheriff/live_view.hpp"
#include "procman/sheriff/printable.hpp"
#include "procman/sheriff/script_runner.hpp"
#include "procman/sheriff/tasks.hpp"
#include "procman/sheriff/terminal.hpp"

namespace nodmap::procman {
namespace {

constexpr std::chrono::milliseconds kKeyWait = 50ms;
constexpr time::Duration kReminderPeriod = 5s;

enum class Role : std::uint8_t {
  kLooking,    // for other sheriffs, and gives no orders yet
  kInCommand,  // gives orders
  kYielded,    // to another sheriff, until that has ended
  kObserver,
};

// A sheriff that keeps running: script, health rules, detection of another sheriff; with a live
// view or line by line.
class Watch {
 public:
  Watch(Sheriff& sheriff, const WatchOptions& options)
      : sheriff_(sheriff),
        options_(options),
        config_watch_(options.config_file, ConfigWatch::kSheriffSettle, Sheriff::now()) {
    if (options.script != nullptr) {
      begin_script(*options.script);
    }
    if (Terminal::is_there()) {
      terminal_ = std::make_unique<Terminal>();
    }
    begin_ = reminded_ = Sheriff::now();
    role_ = options.observe ? Role::kObserver : Role::kLooking;
  }

  int run() {
    while (!exit_code_ && !node::stop_requested()) {
      sheriff_.work(kKeyWait);
      look_for_other_sheriff();
      step_script();
      reload_config();
      for (const HealthWatch::Restart& restart : sheriff_.apply_health_rules()) {
        notify("restarting " + restart.command_id + ": " + restart.reason);
      }
      warn();
      terminal_ ? show() : print_changes();
    }
    return exit_code_.value_or(code_of_stop());
  }

 private:
  void begin_script(const Script& script);
  void begin_script_of_key(std::size_t index);
  void step_script();
  void end_script();
  [[nodiscard]] int code_of_stop() const;
  void reload_config();
  void look_for_other_sheriff();
  void take_command();
  void yield_to(const std::string& other);
  void warn();
  void notify(const std::string& text);
  void show();
  [[nodiscard]] const Console* output() const;
  void fulfil(const KeyRequest& request);
  void order(const OrderRequest& request);
  [[nodiscard]] std::string title() const;
  void print_changes();

  Sheriff& sheriff_;
  WatchOptions options_;
  ConfigWatch config_watch_;
  std::optional<ScriptRunner> runner_;
  std::string script_name_;
  bool is_script_of_key_ = false;  // then its end does not end the watch
  std::unique_ptr<Terminal> terminal_;
  LiveView view_;
  std::map<std::string, std::string> printed_;
  std::optional<int> exit_code_;
  Role role_ = Role::kObserver;
  time::SteadyTime begin_{};
  time::SteadyTime reminded_{};
  bool has_failed_ = false;            // the script has failed
  bool knows_other_ = false;           // it was reported that another one gives orders as well
  std::vector<std::string> warnings_;  // that were reported
};

void Watch::warn() {
  std::vector<std::string> warnings = sheriff_.warnings();
  for (const std::string& warning : warnings) {
    if (std::ranges::find(warnings_, warning) == warnings_.end()) {
      notify(warning);
    }
  }
  warnings_ = std::move(warnings);
}

void Watch::notify(const std::string& text) {
  if (terminal_) {
    view_.set_message(printable(text));
  } else {
    std::cout << printable(text)
              << std::endl;  // NOLINT(performance-avoid-endl): readers get each line at once
  }
}

void Watch::begin_script(const Script& script) {
  script_name_ = script.name;
  runner_.emplace(sheriff_.config(), script,
                  [this](const std::string& id) { return sheriff_.is_healthy(id); });
}

void Watch::begin_script_of_key(std::size_t index) {
  const auto& scripts = sheriff_.config().scripts;
  if (index >= scripts.size()) {
    notify("there is no script " + std::to_string(index + 1));
  } else if (runner_ && !runner_->is_over()) {
    notify("not now: the script " + script_name_ + " is still running");
  } else {
    is_script_of_key_ = true;
    begin_script(scripts[index]);
    notify("script " + script_name_);
  }
}

void Watch::step_script() {
  const time::SteadyTime now = Sheriff::now();
  if (!runner_ || runner_->is_over() || role_ != Role::kInCommand) {
    return;
  }
  const std::string waited_for = runner_->waiting_for();
  runner_->step(sheriff_.fleet(), now);
  if (runner_->is_over()) {
    sheriff_.give_orders();
    end_script();
    return;
  }
  if (runner_->waiting_for() != waited_for) {
    sheriff_.give_orders();
    reminded_ = now;
  } else if (now - reminded_ > kReminderPeriod) {
    reminded_ = now;
    notify("waiting for " + runner_->waiting_for());
  }
  if (options_.timeout_s && !is_script_of_key_ &&
      time::seconds(now - begin_) > *options_.timeout_s) {
    notify("the script has not ended in time: waiting for " + runner_->waiting_for());
    exit_code_ = exit_code::kFailed;
  }
}

void Watch::end_script() {
  const bool has_failed = !runner_->failure().empty();
  notify("script " + script_name_ +
         (has_failed ? " has failed: " + runner_->failure() : " is done"));
  if (is_script_of_key_) {
    return;
  }
  has_failed_ = has_failed;
  if (options_.after_script == AfterScript::kExit) {
    exit_code_ = has_failed_ ? exit_code::kFailed : exit_code::kDone;
  } else if (options_.after_script == AfterScript::kObserve) {
    role_ = Role::kObserver;
    sheriff_.observe();
  }
}

// The exit code after a signal. A sheriff that was to stay has ended as it should, whatever became
// of its script: systemd runs a service's stop script only if its program did not fail.
int Watch::code_of_stop() const {
  const bool is_cut_short = runner_ && !runner_->is_over();
  const bool stays = options_.after_script == AfterScript::kStay;
  return !stays && (is_cut_short || has_failed_) ? exit_code::kFailed : exit_code::kDone;
}

// Not while a script runs, because it refers to the previous configuration.
void Watch::reload_config() {
  if (runner_ && !runner_->is_over()) {
    return;
  }
  std::optional<ParsedConfig> parsed = config_watch_.poll(Sheriff::now());
  if (!parsed) {
    return;
  }
  if (!parsed->errors.empty()) {
    notify(describe(options_.config_file, parsed->errors.front()) + " (configuration unchanged)");
    return;
  }
  notify(options_.config_file + " was edited");
  for (const std::string& change : sheriff_.reconfigure(std::move(parsed->config))) {
    notify(change);
  }
}

// One of two sheriffs must stop giving orders, because they would contradict each other.
void Watch::look_for_other_sheriff() {
  const time::SteadyTime now = Sheriff::now();
  const auto other = sheriff_.fleet().other_sheriffs().running(now);
  const bool must_yield =
      role_ == Role::kLooking || (role_ == Role::kInCommand && sheriff_.fleet().must_yield(now));
  if (other && must_yield) {
    yield_to(*other);
  } else if (role_ == Role::kLooking && !is_looking_for_others(sheriff_.fleet(), begin_, now)) {
    take_command();
  } else if (role_ == Role::kInCommand && other.has_value() != knows_other_) {
    knows_other_ = other.has_value();
    notify(other ? "the sheriff " + *other + " gives orders here as well: two sheriffs"
                 : "no other sheriff gives orders any more");
  } else if (role_ == Role::kYielded && !other) {
    take_command();
    notify("the other sheriff has ended: giving orders again");
  }
}

void Watch::take_command() {
  role_ = Role::kInCommand;
  sheriff_.take_command();
}

// A sheriff that has given orders takes the command again when the other one has ended.
void Watch::yield_to(const std::string& other) {
  role_ = role_ == Role::kInCommand ? Role::kYielded : Role::kObserver;
  sheriff_.observe();
  notify("the sheriff " + other + " gives orders here: observing only");
  if (runner_ && !runner_->is_over()) {
    exit_code_ = exit_code::kOtherSheriff;
  }
}

std::string Watch::title() const {
  std::string title = "nodmap-sheriff";
  if (role_ == Role::kLooking) {
    title += ": looking for other sheriffs";
  } else if (role_ != Role::kInCommand) {
    title += ": observing only";
  }
  if (runner_ && !runner_->is_over()) {
    title += "; script " + script_name_ + ": waiting for " + runner_->waiting_for();
  }
  return printable(title);
}

void Watch::show() {
  view_.update(sheriff_.report());
  while (const std::optional<Key> key = terminal_->key()) {
    if (const std::optional<KeyRequest> request = view_.press(*key, output())) {
      fulfil(*request);
    }
  }
  const Terminal::Size size = Terminal::size();
  terminal_->draw(view_.lines(title(), output(), sheriff_.config().scripts, size), size);
}

// The output of the selected command, or null.
const Console* Watch::output() const {
  const ReportRow* selected = view_.selected();
  return selected == nullptr ? nullptr : sheriff_.console(selected->id);
}

void Watch::fulfil(const KeyRequest& request) {
  if (std::holds_alternative<QuitRequest>(request)) {
    exit_code_ = exit_code::kDone;
  } else if (role_ != Role::kInCommand) {
    notify(role_ == Role::kLooking ? "not yet: looking for other sheriffs"
                                   : "observing only: no orders");
  } else if (const auto* script = std::get_if<ScriptRequest>(&request)) {
    begin_script_of_key(script->index);
  } else {
    order(std::get<OrderRequest>(request));
  }
}

void Watch::order(const OrderRequest& request) {
  for (const std::string& command : request.commands) {
    sheriff_.fleet().order(request.verb, command);
  }
  sheriff_.give_orders();
  notify(name_of(request.verb) + std::string(" ") + request.target);
}

void Watch::print_changes() {
  for (const ReportRow& row : sheriff_.report()) {
    const std::string state = state_sentence(row);
    std::string& printed = printed_[row.id];
    if (printed != state) {
      printed = state;
      notify(row.id + ": " + state);
    }
  }
}

}  // namespace

int watch(Sheriff& sheriff, const WatchOptions& options) {
  return Watch(sheriff, options).run();
}

}  // namespace nodmap::procman
