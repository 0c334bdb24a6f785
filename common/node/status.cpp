// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/status.hpp"

#include "nodmap/status_t.hpp"

namespace nodmap::node {
namespace {

// Up to this many corrupt messages in a second are counted, but do not degrade the health.
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
      last_(clock.now()) {}

void StatusReporter::publish_if_due(const Node& node) {
  if (is_due()) {
    publish(node.health());
  }
}

void StatusReporter::publish_if_due(const Health& health) {
  if (is_due()) {
    publish(health);
  }
}

bool StatusReporter::is_due() const {
  const time::Duration elapsed = clock_.now() - last_;
  // After the clock was set back, STATUS continues at once.
  return elapsed < 0s || elapsed >= kStatusPeriod;
}

void StatusReporter::publish(const Health& node_health) {
  const time::Timestamp now = clock_.now();
  const time::Duration elapsed = now - last_;
  const bus::BusCounts bus_counts = bus_.counts();
  const Health health = health_by_messages(node_health, bus_counts);
  const bus::LatencyMeter::Summary latency = bus_.latency().summary_since_last();
  nodmap::status_t message{};
  message.utime = time::to_utime(now);
  message.process_name = process_name_;
  message.health = to_message(health.state);
  message.health_reason = health.reason;
  message.handled_per_s = elapsed > 0s
                              ? static_cast<double>(bus_counts.received - last_counts_.received) /
                                    time::seconds(elapsed)
                              : 0.0;
  message.latency_p50_us = latency.p50_us;
  message.latency_p99_us = latency.p99_us;
  message.total_handled = bus_counts.received;
  message.total_lost = counts_.lost();
  message.total_corrupt = bus_counts.corrupt;
  message.total_rejected = counts_.total_rejected() + bus_counts.refused;
  bus_.publish("STATUS", message);
  last_ = now;
  last_counts_ = bus_counts;
}

Health StatusReporter::health_by_messages(const Health& node_health,
                                          const bus::BusCounts& now) const {
  if (node_health.state != HealthState::kOk) {
    return node_health;
  }
  if (now.refused > last_counts_.refused) {
    return {HealthState::kDegraded, "messages of " + now.refused_host +
                                        " are refused: it is not among NODMAP_TRUSTED_HOSTS"};
  }
  if (now.overrun > last_counts_.overrun) {
    return {
        HealthState::kDegraded,
        std::to_string(now.overrun - last_counts_.overrun) +
            " messages dropped: they came faster than they were handled; the machine is too busy"};
  }
  if (now.corrupt - last_counts_.corrupt > kCorruptByAccident) {
    return {HealthState::kDegraded, "corrupt messages: a fault, or an attack"};
  }
  if (node_health.needs_messages && now.received == last_counts_.received) {
    return {HealthState::kDegraded, "no input in the last second"};
  }
  return node_health;
}

}  // namespace nodmap::node
