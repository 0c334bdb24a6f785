// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/bus/bus.hpp"
#include "common/node/clock.hpp"
#include "common/node/node.hpp"

namespace nodmap::node {

/// Publishes STATUS once a second: the node's health; or, while that is OK, DEGRADED when no
/// message came in, or some that may be an attack.
class StatusReporter {
 public:
  StatusReporter(std::string process_name, bus::Bus& bus, const MessageCounts& counts,
                 const time::Clock& clock);

  void publish_if_due(const Node& node) { publish_if_due(node.health()); }
  /// For a process that is no Node.
  void publish_if_due(const Health& node_health);

 private:
  /// What the messages of the last second say of the node that calls itself OK.
  [[nodiscard]] Health health_by_messages(const Health& node_health,
                                          const bus::BusCounts& now) const;

  std::string process_name_;
  bus::Bus& bus_;
  const MessageCounts& counts_;
  const time::Clock& clock_;
  time::Timestamp last_;  // STATUS
  bus::BusCounts last_counts_;
};

}  // namespace nodmap::node
