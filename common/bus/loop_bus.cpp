// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loop_bus.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::bus {

LoopNetwork::LoopNetwork(const std::filesystem::path& log, const LoopDelay& delay)
    : log_(log), delay_(delay), engine_(delay.seed) {}

void LoopNetwork::deliver() {
  while (!deliveries_.empty() && deliveries_.begin()->first.stamp <= now_.wall) {
    const time::Timestamp received = deliveries_.begin()->first.stamp;
    const Delivery delivery = std::move(deliveries_.begin()->second);
    deliveries_.erase(deliveries_.begin());
    delivery.owner->set_origin({delivery.sender, received, now_.steady - (now_.wall - received)});
    (*delivery.handler)(*delivery.bytes);
  }
}

// Another one than all before.
Sender LoopNetwork::new_sender() {
  constexpr std::uint32_t kThisHost = 0x7F000001;
  return {kThisHost, ++num_senders_};
}

bool LoopNetwork::send(const Sender& sender, const std::string& channel,
                       std::span<const std::byte> bytes) {
  log_complete_ = log_.write(time::to_utime(now_.wall), channel, bytes) && log_complete_;
  const auto found = listeners_.find(channel);
  if (found == listeners_.end()) {
    return log_complete_;
  }
  const auto copy = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
  for (const Listener& listener : found->second) {
    time::Timestamp& last_due = listener.owner->last_due_;
    last_due = std::max(last_due, now_.wall + delay_.min + jitter());
    deliveries_.emplace(Due{last_due, num_deliveries_++},
                        Delivery{listener.owner, &listener.handler, sender, copy});
  }
  return log_complete_;
}

time::Duration LoopNetwork::jitter() {
  constexpr double kMaxMultiple = 10.0;
  if (delay_.mean_jitter == 0s) {
    return 0s;
  }
  const double multiple = std::exponential_distribution<double>()(engine_);
  return time::rounded(std::min(multiple, kMaxMultiple) * time::FineDuration(delay_.mean_jitter));
}

void LoopNetwork::listen(LoopBus* owner, const std::string& channel, Bus::BytesHandler handler) {
  listeners_[channel].push_back({owner, std::move(handler)});
}

void LoopNetwork::leave(const LoopBus* owner) {
  std::erase_if(deliveries_, [owner](const auto& entry) { return entry.second.owner == owner; });
  for (auto& [channel, listeners] : listeners_) {
    std::erase_if(listeners, [owner](const Listener& listener) { return listener.owner == owner; });
  }
}

}  // namespace nodmap::bus
