// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/geometry/time.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/console.hpp"
#include "procman/protocol/fleet.hpp"
#include "procman/sheriff/health_watch.hpp"
#include "procman/sheriff/report.hpp"

namespace nodmap::procman {

/// Connects a fleet to the network: receives the deputies' reports and sends them orders, once a
/// second and on changes. An observer sends none.
class Sheriff : boost::noncopyable {
 public:
  using OutputHandler = std::function<void(const std::string& command, const std::string& text)>;

  /// Starts as an observer, because a sheriff must look for others before it gives orders.
  Sheriff(Config config, const std::string& lcm_url);
  /// Tells the deputies that it has ended, so that they obey the next sheriff at once.
  ~Sheriff();

  /// Handles messages for at most `wait`, and sends the orders that are due.
  void work(std::chrono::milliseconds wait);

  /// Sends the orders at once, because the requested states have changed.
  void give_orders();
  void take_command() { fleet_.take_command(now()); }
  void observe() { fleet_.observe(); }

  /// Does the restarts that the health rules require; returns them with their reasons.
  std::vector<HealthWatch::Restart> apply_health_rules();

  /// Adopts an edited configuration; see Fleet::reconfigure(). Must not be called while a script of
  /// the one before runs.
  std::vector<std::string> reconfigure(Config config);

  /// Whether the present process of a command has reported OK recently.
  [[nodiscard]] bool is_healthy(const std::string& command) const;

  /// What the commands write from now on.
  void on_output(OutputHandler handler) { output_handler_ = std::move(handler); }
  /// The last output of each command, which its deputy sends after a sheriff has begun: after all
  /// output that it contains, and before what follows it.
  void on_last_output(OutputHandler handler) { last_output_handler_ = std::move(handler); }

  [[nodiscard]] Fleet& fleet() { return fleet_; }
  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] std::vector<ReportRow> report() const;
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// The output of a command; null if none was received.
  [[nodiscard]] const Console* console(const std::string& command) const;
  /// The time used for the fleet.
  [[nodiscard]] static time::SteadyTime now() { return time::steady_now(); }

 private:
  void subscribe();
  [[nodiscard]] bool is_from_deputy(const Output& output) const;
  void take_output(const Output& output);
  void take_last_output(const Output& output);

  Config config_;
  time::SystemClock clock_;
  bus::LiveBus bus_;
  Fleet fleet_;
  HealthWatch health_;
  std::map<std::string, Console> consoles_;
  OutputHandler output_handler_;
  OutputHandler last_output_handler_;
  bool has_given_orders_ = false;
  bool are_orders_wanted_ = false;
  time::SteadyTime orders_due_{};
};

}  // namespace nodmap::procman
