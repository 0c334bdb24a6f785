// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/deputy.hpp"

#include <poll.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <sstream>
#include <utility>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/node/serial_workers.hpp"
#include "common/node/status.hpp"
#include "procman/config/config_watch.hpp"
#include "procman/deputy/children.hpp"
#include "procman/deputy/output_collector.hpp"
#include "procman/deputy/refusals.hpp"
#include "procman/deputy/senders.hpp"
#include "procman/deputy/signal_reader.hpp"
#include "procman/deputy/supervisor.hpp"
#include "procman/deputy/system_load.hpp"
#include "procman/protocol/host.hpp"
#include "procman/protocol/messages.hpp"

namespace nodmap::procman {
namespace {

constexpr time::Duration kDiscoveryTime = 500ms;
constexpr time::Duration kDiscoverPeriod = 200ms;
constexpr time::Duration kInfoPeriod = 1s;
constexpr time::Duration kLongestWait = 200ms;

class Deputy {
 public:
  explicit Deputy(const DeputySettings& settings)
      : settings_(settings),
        bus_(settings.lcm_url),
        children_(settings.id, own_folder(),
                  [this](const std::string& id, std::string_view text) {
                    output_.add(id, text, time::steady_now());
                  }),
        supervisor_(settings.id, settings.trusts_orders),
        senders_(settings.id, (time::to_utime(clock_.now()) << 22U) + ::getpid()),
        status_("nodmap-deputy", bus_, counts_, clock_),
        started_(time::steady_now()) {
    if (!settings.config_file.empty()) {
      config_watch_.emplace(settings.config_file, ConfigWatch::kDeputySettle, started_,
                            settings.id);
    }
  }

  int run() {
    if (node::stop_requested()) {
      return 0;  // by a signal that came before the SignalReader
    }
    subscribe();
    log::get().info("deputy {} on {}", settings_.id, bus_.url());
    while (!exit_code_) {
      wait();
      handle_signals();
      reload_config();
      bus_.handle(0ms);  // limited, so that a flood of orders cannot block the loop
      work();
    }
    Children::kill_everything();  // before the last output is published
    while (const auto due = output_.due()) {
      publish_output(*due);  // publish all remaining output
    }
    return *exit_code_;
  }

 private:
  void subscribe();
  void wait();
  void handle_signals();
  void reload_config();
  void work();
  void work_discovery(time::SteadyTime now);
  void begin_service(time::SteadyTime now);
  void on_discovery(const Discovery& discovery);
  void on_info(const std::string& deputy_id);
  void on_orders(const procman_lcm::orders_t& message);
  [[nodiscard]] bool obeys(const std::string& sheriff_id);
  void log_end(const Children::Ended& end);
  void carry_out(const SupervisorActions& actions);
  void carry_out(const StartCommand& action);
  void carry_out(const SignalCommand& action);
  void carry_out(const WriteOutput& action);
  void carry_out(const ForgetCommand& action);
  void carry_out(const PublishInfo& /*action*/) { has_info_changed_ = true; }
  void carry_out(const RefuseOrder& action) { refusals_.add(action, time::steady_now()); }
  [[nodiscard]] node::Health health(time::SteadyTime now) const;
  void publish_output(time::SteadyTime now);
  void publish_output(const char* channel, std::vector<CommandOutput> outputs);
  void publish_info();
  void raise_serial_workers();
  [[nodiscard]] std::vector<pid_t> pids() const;

  DeputySettings settings_;
  std::optional<ConfigWatch> config_watch_;
  SignalReader signals_;
  time::SystemClock clock_;
  node::MessageCounts counts_;
  bus::LiveBus bus_;
  Children children_;
  Supervisor supervisor_;
  Senders senders_;
  OutputCollector output_;
  SystemLoad load_;
  node::SerialWorkers serial_workers_;
  node::StatusReporter status_;
  time::SteadyTime started_;
  std::optional<time::SteadyTime> discover_due_;  // empty: none was sent yet
  time::SteadyTime info_due_{};
  bool is_serving_ = false;
  bool has_info_changed_ = false;
  Refusals refusals_{counts_};
  std::optional<int> exit_code_;
};

void Deputy::subscribe() {
  bus_.subscribe<procman_lcm::discovery_t>(
      kDiscoverChannel, [this](const auto& message) { on_discovery(from_message(message)); });
  bus_.subscribe<procman_lcm::deputy_info_t>(
      kInfoChannel, [this](const auto& message) { on_info(message.deputy_id); });
  bus_.subscribe<procman_lcm::orders_t>(kOrdersChannel,
                                        [this](const auto& message) { on_orders(message); });
}

// Takes the report of a deputy, which may be our own.
void Deputy::on_info(const std::string& deputy_id) {
  if (deputy_id != settings_.id) {
    return;
  }
  if (!is_serving_) {
    log::get().error("a deputy {} is already running", settings_.id);
    exit_code_ = 1;
  } else if (senders_.is_impostor(bus_.origin().sender)) {
    refusals_.add({"other_deputy", "another process reports as the deputy " + deputy_id},
                  time::steady_now());
  }
}

void Deputy::on_orders(const procman_lcm::orders_t& message) {
  if (!is_serving_) {
    return;
  }
  if (message.ncmds > static_cast<int>(Supervisor::kMaxCommands)) {
    counts_.reject("too_many_commands");
    return;
  }
  counts_.use();
  const time::Duration age = clock_.now() - time::from_utime(message.utime);
  const bool is_for_us = message.deputy_id == settings_.id && age <= Supervisor::kMaxOrdersAge;
  if (!is_for_us || obeys(message.sheriff_id)) {
    carry_out(supervisor_.take_orders(from_message(message), age, time::steady_now()));
  }
}

// Whether the orders being handled are obeyed: not those of a second sheriff, which would
// contradict the first.
bool Deputy::obeys(const std::string& sheriff_id) {
  const bus::Origin& origin = bus_.origin();
  const bool is_followed = senders_.follow_sheriff(origin.sender, origin.arrived);
  if (is_followed || settings_.trusts_orders) {
    return true;
  }
  refusals_.add({"other_sheriff", "orders of a second sheriff are refused: " + sheriff_id},
                time::steady_now());
  return false;
}

void Deputy::on_discovery(const Discovery& discovery) {
  if (senders_.take_own(discovery, bus_.origin().sender)) {
    return;
  }
  if (is_serving_) {
    has_info_changed_ = true;
    // A sheriff sends it when it begins and when it ends.
    if (discovery.nonce == 0 && !senders_.end_sheriff(bus_.origin().sender)) {
      output_.repeat();
    }
  } else if (discovery.transmitter_id == settings_.id) {
    log::get().error("another deputy {} is being started", settings_.id);
    exit_code_ = 1;
  }
}

void Deputy::wait() {
  const time::SteadyTime now = time::steady_now();
  std::vector<pollfd> waiting{{signals_.poll_handle(), POLLIN, 0}, {bus_.poll_handle(), POLLIN, 0}};
  children_.add_to_poll(waiting, now);
  time::SteadyTime next =
      std::min(now + kLongestWait, is_serving_ ? info_due_ : discover_due_.value_or(now));
  for (const auto& due :
       {supervisor_.next_due(), output_.due(), output_.repeat_due(), children_.due(now)}) {
    next = std::min(next, due.value_or(next));
  }
  const auto timeout = std::chrono::ceil<std::chrono::milliseconds>(std::max(next, now) - now);
  ::poll(waiting.data(), waiting.size(), static_cast<int>(timeout.count()));
}

void Deputy::handle_signals() {
  while (const std::optional<int> signal = signals_.next()) {
    if (*signal == SIGCHLD) {
      continue;  // work() collects ended children in any case
    }
    log::get().info("signal {}: stopping everything{}", *signal,
                    supervisor_.is_shutting_down() ? ", at once" : "");
    carry_out(supervisor_.shut_down(time::steady_now()));
  }
}

// Running commands continue; the sheriff decides about them.
void Deputy::reload_config() {
  const auto parsed = config_watch_ ? config_watch_->poll(time::steady_now()) : std::nullopt;
  if (!parsed) {
    return;
  }
  for (const ConfigError& error : parsed->errors) {
    log::get().error("{} (configuration unchanged)", describe(settings_.config_file, error));
  }
  if (parsed->errors.empty()) {
    settings_.permissions = Permissions(settings_.id, parsed->config);
    supervisor_.retry_refused(time::steady_now());
    log::get().info("{} was reloaded", settings_.config_file);
  }
}

void Deputy::work() {
  const time::SteadyTime now = time::steady_now();
  children_.read_output(now);
  for (const Children::Ended& end : children_.reap(now)) {
    log_end(end);
    carry_out(supervisor_.ended(end.id, end.wait_status, now));
  }
  carry_out(supervisor_.poll(now));
  if (!is_serving_) {
    work_discovery(now);
  } else if (has_info_changed_ || now >= info_due_) {
    if (now >= info_due_) {
      load_.sample(pids());
      children_.kill_strays();
      raise_serial_workers();
      info_due_ = std::max(info_due_ + kInfoPeriod, now);
    }
    publish_info();
  }
  publish_output(now);
  status_.publish_if_due(health(now));
  if (supervisor_.is_shutting_down() && supervisor_.is_idle()) {
    exit_code_ = exit_code_.value_or(0);
  }
}

// Logs the end of a command; if it has failed also the last lines of its run, for the journal.
void Deputy::log_end(const Children::Ended& end) {
  log::get().info("{} ended (wait status {})", end.id, end.wait_status);
  if (end.wait_status == 0) {
    return;
  }
  std::istringstream lines{std::string(output_.recent_of_run(end.id))};
  for (std::string line; std::getline(lines, line);) {
    std::erase_if(line, [](char c) { return c >= 0 && c < ' '; });
    log::get().warn("{}: {}", end.id, line);
  }
}

void Deputy::work_discovery(time::SteadyTime now) {
  if (discover_due_ && now >= started_ + kDiscoveryTime) {
    begin_service(now);
  } else if (now >= discover_due_.value_or(now)) {
    discover_due_ = now + kDiscoverPeriod;
    bus_.publish(kDiscoverChannel,
                 to_message(Discovery{clock_.now(), settings_.id, senders_.nonce()}));
  }
}

void Deputy::begin_service(time::SteadyTime now) {
  const int leftovers = children_.kill_leftovers();
  if (leftovers > 0) {
    log::get().warn("killed {} processes left behind by a killed deputy", leftovers);
  }
  is_serving_ = true;
  info_due_ = now;
  log::get().info("serving");
}

void Deputy::carry_out(const SupervisorActions& actions) {
  for (const SupervisorAction& action : actions) {
    std::visit([this](const auto& what) { carry_out(what); }, action);
  }
}

void Deputy::carry_out(const SignalCommand& action) {
  log::get().info("{}: signal {}", action.id, action.signal);
  children_.signal(action.id, action.signal);
}

void Deputy::carry_out(const WriteOutput& action) {
  output_.add(action.id, action.text, time::steady_now());
}

void Deputy::carry_out(const ForgetCommand& action) {
  output_.forget(action.id);
  has_info_changed_ = true;
}

void Deputy::carry_out(const StartCommand& action) {
  const time::SteadyTime now = time::steady_now();
  const auto resources = settings_.permissions.resources_of(action.id, action.exec);
  if (!resources) {
    refusals_.add({"not_allowed", action.id + ": refused: " + action.exec}, now);
    carry_out(supervisor_.refused(action.id,
                                  "nodmap-deputy: refused: " + settings_.config_file +
                                      " lists no such name and exec line for " + settings_.id,
                                  now));
    return;
  }
  output_.begin_run(action.id);
  try {
    const pid_t pid = children_.start(action.id, action.exec, *resources);
    supervisor_.started(action.id, pid, now);
    log::get().info("{} started (pid {})", action.id, pid);
    has_info_changed_ = true;
  } catch (const std::exception& error) {
    log::get().error("{}: {}", action.id, error.what());
    carry_out(supervisor_.not_started(action.id, error.what(), now));
  }
}

node::Health Deputy::health(time::SteadyTime now) const {
  node::Health health = refusals_.health(now);
  health.needs_messages = false;  // a deputy without a sheriff is healthy
  return health;
}

void Deputy::publish_output(time::SteadyTime now) {
  publish_output(kOutputChannel, output_.take(now));
  publish_output(kLastOutputChannel, output_.take_repeated(now));
}

void Deputy::publish_output(const char* channel, std::vector<CommandOutput> outputs) {
  if (!outputs.empty()) {
    bus_.publish(channel, to_message(Output{clock_.now(), settings_.id, std::move(outputs)}));
  }
}

void Deputy::publish_info() {
  has_info_changed_ = false;
  DeputyInfo info;
  info.stamp = clock_.now();
  info.deputy_id = settings_.id;
  load_.describe_host(info);
  info.commands = supervisor_.statuses();
  for (CommandStatus& status : info.commands) {
    load_.describe_process(status);
  }
  bus_.publish(kInfoChannel, to_message(info));
  bus_.publish(kRunsChannel,
               to_message(Runs{info.stamp, settings_.id, supervisor_.runs(time::steady_now())}));
}

// Raises the kernel's serial workers while a command with real-time priority runs, so that the
// bytes of its devices are not delayed either.
void Deputy::raise_serial_workers() {
  const std::vector<pid_t> running = pids();
  serial_workers_.keep_raised(std::ranges::any_of(running, [](pid_t pid) {
    return ::sched_getscheduler(pid) == SCHED_RR;  // the file may have been edited since its start
  }));
}

std::vector<pid_t> Deputy::pids() const {
  std::vector<pid_t> all;
  for (const CommandStatus& status : supervisor_.statuses()) {
    if (status.pid != 0) {
      all.push_back(status.pid);
    }
  }
  return all;
}

}  // namespace

int run_deputy(const DeputySettings& settings) {
  return Deputy(settings).run();
}

}  // namespace nodmap::procman
