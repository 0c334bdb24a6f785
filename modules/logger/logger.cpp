// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/logger.hpp"

#include <utility>

#include "common/node/log.hpp"
#include "common/node/program.hpp"

namespace nodmap::logger {
namespace {

// Together with Recorder::kFlushPeriod, limits how long an event waits for its flush.
constexpr std::chrono::milliseconds kWait = 20ms;
// A thread of the bus reads messages from the socket. When none has arrived for this long after the
// signal, no received message is left in it.
constexpr std::chrono::milliseconds kSilence = 100ms;
// Other processes may continue to send; this limit ends the work within the second that a process
// has to stop.
constexpr time::Duration kDrainLimit = 600ms;

}  // namespace

Logger::Logger(const std::string& url, int queue_messages, ChannelFilter filter,
               const RecorderSettings& settings)
    : filter_(std::move(filter)),
      bus_(url),
      recorder_(settings, clock_),
      status_(kProgram, bus_, counts_, clock_) {
  bus_.subscribe_all([this](const auto& message) { take(message); }, queue_messages);
  log::get().info("listening on {}", bus_.url());
}

void Logger::run() {
  while (!node::stop_requested()) {
    work(kWait);
  }
  drain();
  recorder_.close();
}

// Returns the number of messages that were handled.
int Logger::work(std::chrono::milliseconds wait) {
  const int handled = bus_.handle(wait);
  recorder_.tick();
  count_dropped();
  status_.publish_if_due(recorder_.health());
  return handled;
}

void Logger::take(const bus::LiveBus::RawMessage& message) {
  newest_ = message.received;
  counts_.lose(losses_.lost_before(message.channel, message.data));
  if (!filter_.wants(message.channel)) {
    return;
  }
  recorder_.record(message.received, message.channel, message.data);
}

// Events are lost when they are recorded and when they are flushed.
void Logger::count_dropped() {
  counts_.reject("no_room", recorder_.counts().dropped - dropped_);
  dropped_ = recorder_.counts().dropped;
}

// Records everything that this host received before the signal.
void Logger::drain() {
  const time::Timestamp stop = clock_.now();
  const time::SteadyTime deadline = time::steady_now() + kDrainLimit;
  while (time::steady_now() < deadline && work(kSilence) > 0 && newest_ <= stop) {
  }
}

}  // namespace nodmap::logger
