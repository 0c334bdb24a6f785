// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/bus/bus.hpp"
#include "common/node/node.hpp"
#include "common/time/clock.hpp"

namespace nodmap::node {

/// Sends STATUS once a second: the process's own word, or DEGRADED when nothing comes in.
class StatusReporter {
 public:
  StatusReporter(std::string process_name, bus::Bus& bus, const Tally& tally,
                 const time::Clock& clock);

  void publish_if_due(const Node& node) { publish_if_due(node.health()); }
  /// For a process that is no Node.
  void publish_if_due(const Health& own_word);

 private:
  std::string process_name_;
  bus::Bus& bus_;
  const Tally& tally_;
  const time::Clock& clock_;
  std::int64_t last_utime_us_;
  std::int64_t last_received_ = 0;
};

}  // namespace nodmap::node
