// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/node.hpp"
#include "procman/deputy/supervisor.hpp"

namespace nodmap::procman {

/// What the deputy has refused, orders and reports in its own name: counts it by cause, and reports
/// the last one.
class Refusals {
 public:
  explicit Refusals(node::MessageCounts& counts) : counts_(counts) {}

  /// Counts a refusal. Logs only the first one after a while without any: a flood of orders must
  /// not fill the journal.
  void add(const RefuseOrder& refusal, time::SteadyTime now);

  /// DEGRADED, with the reason of the last refusal, for 10 s after it; then OK.
  [[nodiscard]] node::Health health(time::SteadyTime now) const;

 private:
  [[nodiscard]] bool is_recent(time::SteadyTime now) const;

  node::MessageCounts& counts_;
  std::string reason_;  // of the last one
  std::optional<time::SteadyTime> last_;
};

}  // namespace nodmap::procman
