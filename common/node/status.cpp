// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/status.hpp"

#include "nodmap/status_t.hpp"

namespace nodmap::node {
namespace {

constexpr std::int64_t kPeriodUs = 1'000'000;
/// So many corrupt messages in a second are told as a count alone.
constexpr std::int64_t kCorruptByAccident = 10;

std::int8_t to_message(HealthState state) {
  switch (state) {
    case HealthState::kOk:
      return nodmap::status_t::OK;
    case HealthState::kDegraded:
      return nodmap::status_t::DEGRADED;
    case HealthState::kFailed:
      break;
  }
  return nodmap::status_t::FAILED;
}

}  // namespace

StatusReporter::StatusReporter(std::string process_name, bus::Bus& bus, const MessageCounts& counts,
                               const time::Clock& clock)
    : process_name_(std::move(process_name)),
      bus_(bus),
      counts_(counts),
      clock_(clock),
      last_utime_us_(clock.now_utime_us()) {}

void StatusReporter::publish_if_due(const Health& node_health) {
  const std::int64_t now_us = clock_.now_utime_us();
  const std::int64_t elapsed_us = now_us - last_utime_us_;
  // A clock set back must not silence the process until it has caught up.
  if (elapsed_us >= 0 && elapsed_us < kPeriodUs) {
    return;
  }
  const bus::BusCounts bus_counts = bus_.counts();
  const Health health = health_by_messages(node_health, bus_counts);
  const bus::LatencyMeter::Summary latency = bus_.latency().take();
  nodmap::status_t message{};
  message.utime = now_us;
  message.process_name = process_name_;
  message.health = to_message(health.state);
  message.health_reason = health.reason;
  message.handled_per_s = elapsed_us > 0
                              ? 1e6 * static_cast<double>(bus_counts.received - last_.received) /
                                    static_cast<double>(elapsed_us)
                              : 0.0;
  message.latency_p50_us = latency.p50_us;
  message.latency_p99_us = latency.p99_us;
  message.total_handled = bus_counts.received;
  message.total_lost = counts_.lost();
  message.total_corrupt = bus_counts.corrupt;
  message.total_rejected = counts_.total_rejected() + bus_counts.refused;
  bus_.publish("STATUS", message);
  last_utime_us_ = now_us;
  last_ = bus_counts;
}

Health StatusReporter::health_by_messages(const Health& node_health,
                                          const bus::BusCounts& now) const {
  if (node_health.state != HealthState::kOk) {
    return node_health;
  }
  if (now.refused > last_.refused) {
    return {HealthState::kDegraded, "messages of " + now.refused_host +
                                        " are refused: it is not among NODMAP_TRUSTED_HOSTS"};
  }
  if (now.overrun > last_.overrun) {
    return {
        HealthState::kDegraded,
        std::to_string(now.overrun - last_.overrun) +
            " messages dropped: they came faster than they were handled; the machine is too busy"};
  }
  if (now.corrupt - last_.corrupt > kCorruptByAccident) {
    return {HealthState::kDegraded, "corrupt messages: a fault, or an attack"};
  }
  if (node_health.needs_messages && now.received == last_.received) {
    return {HealthState::kDegraded, "no input in the last second"};
  }
  return node_health;
}

}  // namespace nodmap::node
