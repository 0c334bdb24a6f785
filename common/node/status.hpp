// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/bus/bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/geometry/time.hpp"
#include "common/node/node.hpp"

namespace nodmap::node {

/// Every process publishes STATUS once in this time.
inline constexpr time::Duration kStatusPeriod = 1s;
/// A process that has published none for so long, which is three, is not running, or hangs.
inline constexpr time::Duration kStatusSilence = 3500ms;

/// Publishes STATUS once a second. It contains the node's health or, if that is OK, DEGRADED when
/// no message arrived, messages were dropped, or received messages may be an attack.
class StatusReporter {
 public:
  StatusReporter(std::string process_name, bus::Bus& bus, const MessageCounts& counts,
                 const time::Clock& clock);

  /// Calls node.health() only when STATUS is due, because it may have to wait for background work.
  void publish_if_due(const Node& node);
  /// For a process that is not a Node.
  void publish_if_due(const Health& health);

 private:
  [[nodiscard]] bool is_due() const;
  void publish(const Health& node_health);
  /// The health of the node, or DEGRADED if it is OK but the messages of the last second are not.
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
