// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "modules/viewer/answer.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/console.hpp"
#include "procman/protocol/deputy_reports.hpp"
#include "procman/protocol/fleet.hpp"
#include "procman/protocol/other_sheriffs.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::viewer {

/// Starts and stops commands of the process manager. For each request it becomes a sheriff: it
/// starts from what the deputies report at that moment and gives orders until the request is
/// fulfilled; running commands continue afterwards. It does not remain a sheriff, because two of
/// them would give contradictory orders. It also keeps the last lines of each command's output.
class ProcessControl {
 public:
  /// Longest time as a sheriff for one request, in addition to the command's grace time.
  static constexpr time::Duration kPatience = 10s;

  using Clock = std::function<time::Moment()>;

  /// The bus must outlive this object.
  ProcessControl(bus::Bus& bus, procman::Config config, Clock clock);

  /// Starts, stops or restarts a command. Refused: unknown names, a deputy that does not answer,
  /// another sheriff that is running.
  [[nodiscard]] Answer change(procman::Verb verb, const std::string& command);
  /// The same for the command that runs nodmap-logger.
  [[nodiscard]] Answer change_recording(procman::Verb verb);

  /// The last lines of a command's output since the construction of this object. Refused: unknown
  /// names.
  [[nodiscard]] Answer output(const std::string& command) const;

  /// Sends the orders that are due, and stops being a sheriff when no request is open. To be called
  /// often.
  void poll();

  /// Adopts an edited configuration; not while is_sheriff(). Running commands continue.
  void set_config(procman::Config config) { config_ = std::move(config); }

  [[nodiscard]] bool is_sheriff() const { return fleet_.has_value(); }
  [[nodiscard]] const procman::Config& config() const { return config_; }

 private:
  void on_info(const procman::DeputyInfo& info);
  void on_orders(const procman::Orders& orders);
  void on_output(const procman::Output& output);
  void begin(const time::Moment& now);
  void give_orders(const time::Moment& now);

  bus::Bus& bus_;
  procman::Config config_;
  Clock clock_;
  std::string id_;                                    // our id as a sheriff, without the start time
  procman::DeputyReports deputies_;                   // of the configuration
  std::map<std::string, procman::Console> consoles_;  // by command, ours only
  procman::OtherSheriffs other_sheriffs_;
  std::optional<procman::Fleet> fleet_;        // while we are a sheriff
  std::map<std::string, procman::Verb> open_;  // the requests that are not fulfilled, by command
  time::SteadyTime leave_{};
  time::SteadyTime orders_due_{};
};

}  // namespace nodmap::viewer
