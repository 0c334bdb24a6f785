// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/event_log.hpp"

namespace nodmap::bus {

class LoopBus;

/// A network within one thread, on a time that its owner sets: what one LoopBus publishes comes to
/// all of them, itself included, `delay_us` later and in the order of publishing. Everything
/// published also goes into an event log. The same calls give the same deliveries and the same log.
class LoopNetwork {
 public:
  /// Throws std::runtime_error when the log cannot be made. The delay stands for what a live
  /// message takes through the kernel until its reader gets to it.
  LoopNetwork(const std::filesystem::path& log, std::int64_t delay_us);

  /// The time on which messages are logged and delivered, microseconds; never back.
  void set_time(std::int64_t utime_us) { utime_us_ = utime_us; }

  /// Delivers what is due, with what handlers publish for the same time meanwhile: each message
  /// after the handler that published it has returned. Exceptions of handlers come out here; the
  /// message is then delivered no further.
  void deliver();

  /// False when the log has not taken everything.
  [[nodiscard]] bool flush() { return log_.flush() && log_complete_; }
  [[nodiscard]] std::int64_t num_messages() const { return log_.num_events(); }

 private:
  friend class LoopBus;

  struct Message {
    std::int64_t due_us = 0;
    std::string channel;
    std::vector<std::byte> bytes;
  };
  struct Listener {
    const LoopBus* owner;
    Bus::BytesHandler handler;
  };

  [[nodiscard]] bool send(const std::string& channel, std::span<const std::byte> bytes);
  void listen(const LoopBus* owner, const std::string& channel, Bus::BytesHandler handler);
  void leave(const LoopBus* owner);

  LogWriter log_;
  bool log_complete_ = true;
  std::int64_t delay_us_;
  std::int64_t utime_us_ = 0;
  std::deque<Message> under_way_;
  std::map<std::string, std::vector<Listener>, std::less<>> listeners_;
};

/// One process's place on a LoopNetwork, which outlives it. When it ends, nothing comes any more to
/// who subscribed through it. Not to be ended from within a handler.
class LoopBus : public Bus {
 public:
  explicit LoopBus(LoopNetwork& network) : network_(network) {}
  ~LoopBus() override { network_.leave(this); }
  LoopBus(const LoopBus&) = delete;
  LoopBus& operator=(const LoopBus&) = delete;
  LoopBus(LoopBus&&) = delete;
  LoopBus& operator=(LoopBus&&) = delete;

 private:
  bool send(const std::string& channel, std::span<const std::byte> bytes) override {
    return network_.send(channel, bytes);
  }
  void listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) override {
    network_.listen(this, channel, std::move(handler));
  }

  LoopNetwork& network_;
};

}  // namespace nodmap::bus
