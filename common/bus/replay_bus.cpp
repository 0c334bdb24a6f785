// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/replay_bus.hpp"

namespace nodmap::bus {

ReplayBus::ReplayBus(const std::filesystem::path& log, const std::filesystem::path& out_log)
    : reader_(log), writer_(out_log) {}

bool ReplayBus::step() {
  const LogEvent* event = reader_.next();
  if (event == nullptr) {
    return false;
  }
  ++events_read_;
  log_time_ = time::from_utime(event->log_utime_us);
  const auto found = handlers_.find(event->channel);
  if (found != handlers_.end()) {
    for (const BytesHandler& handler : found->second) {
      handler(event->data);
    }
  }
  return true;
}

bool ReplayBus::send(const std::string& channel, std::span<const std::byte> bytes) {
  return writer_.write(time::to_utime(log_time_), channel, bytes);
}

void ReplayBus::listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) {
  handlers_[channel].push_back(std::move(handler));
}

}  // namespace nodmap::bus
