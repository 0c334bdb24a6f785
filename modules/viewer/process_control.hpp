// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "modules/viewer/session.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/values.hpp"
#include "procman/sheriff/fleet.hpp"

namespace nodmap::viewer {

/// Starts and stops commands of the process manager, as a sheriff that is there only as long as
/// something is asked for: two sheriffs would pull the commands to and fro. It begins from what the
/// deputies say at that moment, gives orders until all is as wanted, and leaves; what runs goes on.
class ProcessControl {
 public:
  /// Longest time as a sheriff for one request, beside the command's own grace time.
  static constexpr std::int64_t kPatienceUs = 10'000'000;
  static constexpr std::int64_t kOrdersPeriodUs = 1'000'000;

  using Clock = std::function<time::Moment()>;

  /// The bus must outlive this object.
  ProcessControl(bus::Bus& bus, procman::Config config, Clock clock);

  /// Refused: unknown names, a deputy that is not heard, another sheriff at work.
  [[nodiscard]] Answer change(procman::Verb verb, const std::string& command);
  /// The same for the command that runs nodmap-logger.
  [[nodiscard]] Answer change_recording(procman::Verb verb);

  /// To be called often: gives the orders that are due, and leaves when it is time.
  void turn();

  [[nodiscard]] bool is_sheriff() const { return fleet_.has_value(); }
  [[nodiscard]] const procman::Config& config() const { return config_; }

 private:
  struct Heard {
    procman::DeputyInfo info;
    std::int64_t steady_us = 0;
  };

  void on_info(const procman::DeputyInfo& info);
  void on_orders(const procman::Orders& orders);
  void begin(const time::Moment& now);
  void give_orders(const time::Moment& now);
  [[nodiscard]] bool is_heard(const std::string& deputy, std::int64_t steady_us) const;

  bus::Bus& bus_;
  procman::Config config_;
  Clock clock_;
  std::string id_;  // ours as a sheriff, up to the time at which we begin
  std::map<std::string, Heard> heard_;
  std::string other_sheriff_;
  std::int64_t other_heard_us_ = 0;
  std::optional<procman::Fleet> fleet_;  // while we are a sheriff
  std::map<std::string, procman::Wanted> open_;
  std::int64_t leave_us_ = 0;
  std::int64_t orders_due_us_ = 0;
};

}  // namespace nodmap::viewer
