// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

class LoopBus;

/// The time from the publishing of a message until a process handles it: `min`, plus an
/// exponentially distributed part of mean `mean_jitter` (cut off at ten times the mean), drawn
/// for each reader from a generator with this seed. It stands for the kernel and the scheduler.
struct LoopDelay {
  time::Duration min{};
  time::Duration mean_jitter{};
  std::uint64_t seed = 0;
};

/// A network within one thread, on a time that its owner sets: what one LoopBus publishes is
/// delivered to all of them, itself included, after a delay. A LoopBus receives its messages in the
/// order of publishing, as from one socket. Everything published also goes into an event log. The
/// same calls give the same deliveries and the same log.
class LoopNetwork {
 public:
  /// Throws std::runtime_error when the log cannot be created.
  LoopNetwork(const std::filesystem::path& log, const LoopDelay& delay);

  /// The time on which messages are logged and delivered; never back.
  void set_time(time::Timestamp now) { now_ = now; }

  /// Delivers what is due, including what handlers publish meanwhile: each message after the
  /// handler that published it has returned. An exception of a handler comes out here; the message
  /// is not delivered to that handler again.
  void deliver();

  /// False when the log has not taken everything.
  [[nodiscard]] bool flush() { return log_.flush() && log_complete_; }
  [[nodiscard]] std::int64_t num_messages() const { return log_.num_events(); }

 private:
  friend class LoopBus;

  struct Listener {
    LoopBus* owner;
    Bus::BytesHandler handler;
  };
  /// A message on its way to one handler.
  struct Delivery {
    const LoopBus* owner;
    const Bus::BytesHandler* handler;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  /// Deliveries due at the same time are made in the order of publishing.
  struct Due {
    time::Timestamp stamp{};
    std::int64_t number = 0;
    auto operator<=>(const Due&) const = default;
  };

  [[nodiscard]] bool send(const std::string& channel, std::span<const std::byte> bytes);
  void listen(LoopBus* owner, const std::string& channel, Bus::BytesHandler handler);
  void leave(const LoopBus* owner);
  [[nodiscard]] time::Duration jitter();

  LogWriter log_;
  bool log_complete_ = true;
  LoopDelay delay_;
  std::mt19937_64 engine_;
  time::Timestamp now_{};
  std::int64_t num_deliveries_ = 0;
  std::map<Due, Delivery> deliveries_;
  // Lists, so that a delivery's handler stays where it is.
  std::map<std::string, std::list<Listener>, std::less<>> listeners_;
};

/// One process's place on a LoopNetwork, which outlives it. When it ends, nothing comes any more to
/// who subscribed through it. Not to be ended from within a handler.
class LoopBus : public Bus {
 public:
  explicit LoopBus(LoopNetwork& network) : network_(network) {}
  ~LoopBus() override { network_.leave(this); }

 private:
  bool send(const std::string& channel, std::span<const std::byte> bytes) override {
    return network_.send(channel, bytes);
  }
  void listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) override {
    network_.listen(this, channel, std::move(handler));
  }

  friend class LoopNetwork;

  LoopNetwork& network_;
  time::Timestamp last_due_{};
};

}  // namespace nodmap::bus
