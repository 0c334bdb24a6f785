// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loop_bus.hpp"

#include <utility>

namespace nodmap::bus {

LoopNetwork::LoopNetwork(const std::filesystem::path& log, std::int64_t delay_us)
    : log_(log), delay_us_(delay_us) {}

void LoopNetwork::deliver() {
  while (!under_way_.empty() && under_way_.front().due_us <= utime_us_) {
    const Message message = std::move(under_way_.front());
    under_way_.pop_front();
    const auto found = listeners_.find(message.channel);
    if (found == listeners_.end()) {
      continue;
    }
    for (const Listener& listener : found->second) {
      listener.handler(message.bytes);
    }
  }
}

bool LoopNetwork::send(const std::string& channel, std::span<const std::byte> bytes) {
  log_complete_ = log_.write(utime_us_, channel, bytes) && log_complete_;
  // The delay is the same for all, so that the order of sending is the order of arrival.
  under_way_.push_back({utime_us_ + delay_us_, channel, {bytes.begin(), bytes.end()}});
  return log_complete_;
}

void LoopNetwork::listen(const LoopBus* owner, const std::string& channel,
                         Bus::BytesHandler handler) {
  listeners_[channel].push_back({owner, std::move(handler)});
}

void LoopNetwork::leave(const LoopBus* owner) {
  for (auto& [channel, listeners] : listeners_) {
    std::erase_if(listeners, [owner](const Listener& listener) { return listener.owner == owner; });
  }
}

}  // namespace nodmap::bus
