// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstdint>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/process_names.hpp"
#include "common/node/status.hpp"
#include "modules/logger/channel_filter.hpp"
#include "modules/logger/loss_watch.hpp"
#include "modules/logger/recorder.hpp"

namespace nodmap::logger {

inline constexpr const char* kProgram = node::kLogger;

/// Passes messages from the bus to the recorder.
class Logger : private boost::noncopyable {
 public:
  Logger(const std::string& url, int queue_messages, ChannelFilter filter,
         const RecorderSettings& settings);

  /// Records until a stop signal, including everything that this host has received before it.
  void run();

  [[nodiscard]] const RecorderCounts& counts() const { return recorder_.counts(); }
  [[nodiscard]] std::int64_t num_deleted_files() const { return recorder_.num_deleted_files(); }
  [[nodiscard]] std::int64_t lost() const { return counts_.lost(); }

 private:
  int work(std::chrono::milliseconds wait);
  void take(const bus::LiveBus::RawMessage& message);
  void count_dropped();
  void drain();

  time::SystemClock clock_;
  node::MessageCounts counts_;
  ChannelFilter filter_;
  LossWatch losses_;
  bus::LiveBus bus_;
  Recorder recorder_;
  node::StatusReporter status_;
  std::int64_t dropped_ = 0;  // counted so far
  time::Timestamp newest_{};  // when the newest event was received
};

}  // namespace nodmap::logger
