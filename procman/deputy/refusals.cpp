// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/refusals.hpp"

#include "common/node/log.hpp"
#include "common/node/messages.hpp"

namespace nodmap::procman {
namespace {

constexpr time::Duration kReported = 10s;

}  // namespace

void Refusals::add(const RefuseOrder& refusal, time::SteadyTime now) {
  counts_.reject(refusal.cause);
  reason_ = node::read_name(refusal.reason);
  if (!is_recent(now)) {
    log::get().warn("{}", reason_);
  }
  last_ = now;
}

node::Health Refusals::health(time::SteadyTime now) const {
  return is_recent(now) ? node::Health{node::HealthState::kDegraded, reason_} : node::Health{};
}

bool Refusals::is_recent(time::SteadyTime now) const {
  return last_ && now - *last_ < kReported;
}

}  // namespace nodmap::procman
