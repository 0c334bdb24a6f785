// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/clock.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/console.hpp"
#include "procman/protocol/fleet.hpp"
#include "procman/sheriff/health_watch.hpp"
#include "procman/sheriff/report.hpp"

namespace nodmap::procman {

/// A fleet on the network: hears deputies, and gives them orders once a second and when something
/// changes; an observer gives none.
class Sheriff {
 public:
  using OutputHandler = std::function<void(const std::string& command, const std::string& text)>;

  /// An observer at first: whoever wants to command looks for other sheriffs before.
  Sheriff(Config config, const std::string& lcm_url);

  /// Listens for a moment, and gives the orders that are due.
  void work(std::chrono::milliseconds wait);

  /// Orders at once: something is wanted that was not before.
  void give_orders();
  void command() { is_observer_ = false; }
  void observe() { is_observer_ = true; }
  [[nodiscard]] bool is_observer() const { return is_observer_; }

  /// Restarts what the configuration's health rules ask for; their reasons.
  std::vector<HealthWatch::Restart> apply_health_rules();

  /// The configuration was edited; see Fleet::reconfigure(). Not while a script of the former runs.
  std::vector<std::string> reconfigure(Config config);

  /// Whether a command's process has said OK since it runs, and lately.
  [[nodiscard]] bool is_healthy(const std::string& command) const;

  void on_output(OutputHandler handler) { output_handler_ = std::move(handler); }

  [[nodiscard]] Fleet& fleet() { return fleet_; }
  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] std::vector<ReportRow> report() const;
  /// What a command wrote since this sheriff listens; null where that is nothing.
  [[nodiscard]] const Console* console(const std::string& command) const;
  /// Time as the fleet counts it.
  [[nodiscard]] static time::SteadyTime now() { return time::steady_now(); }

 private:
  void subscribe();
  void discover();
  void take_output(const Output& output);

  Config config_;
  time::SystemClock clock_;
  bus::LiveBus bus_;
  Fleet fleet_;
  HealthWatch health_;
  std::map<std::string, Console> consoles_;
  OutputHandler output_handler_;
  bool is_observer_ = true;
  bool orders_wanted_ = false;
  time::SteadyTime orders_due_{};
};

}  // namespace nodmap::procman
