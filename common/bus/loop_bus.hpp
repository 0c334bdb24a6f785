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
#include <system_error>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

class LoopBus;

/// Delay from publishing a message until a process receives it, which models kernel and scheduler:
/// `min` plus an exponentially distributed part with mean `mean_jitter` (limited to ten times the
/// mean), drawn for each subscriber from a random generator with this seed.
struct LoopDelay {
  time::Duration min{};
  time::Duration mean_jitter{};
  std::uint64_t seed = 0;
};

/// A simulated network within one thread; its owner sets the time. A message published by one
/// LoopBus is delivered to all of them, including itself, after a delay. Each LoopBus receives its
/// messages in the order of publishing, as from one socket. All messages are also written to an
/// event log. The same calls give the same deliveries and the same log.
class LoopNetwork {
 public:
  /// Throws std::runtime_error when the log cannot be created.
  LoopNetwork(const std::filesystem::path& log, const LoopDelay& delay);

  /// Sets the time for logging and delivery; must not step back.
  void set_time(const time::Moment& now) { now_ = now; }

  /// Delivers all messages that are due, including those that handlers publish meanwhile, each
  /// after the handler that published it has returned. Whenever it is called, they were received
  /// when they were due, as by the socket of a process that was frozen since. Rethrows the
  /// exception of a handler; the message is not delivered to this handler again.
  void deliver();

  /// False if some messages could not be written to the log.
  [[nodiscard]] bool flush() { return log_.flush() && log_complete_; }
  /// Why they could not be written.
  [[nodiscard]] const std::error_code& failure() const { return log_.failure(); }
  [[nodiscard]] std::int64_t num_messages() const { return log_.num_events(); }

 private:
  friend class LoopBus;

  struct Listener {
    LoopBus* owner;
    Bus::BytesHandler handler;
  };
  /// A message on its way to one handler.
  struct Delivery {
    LoopBus* owner;
    const Bus::BytesHandler* handler;
    Sender sender;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  /// Deliveries due at the same time are made in the order of publishing.
  struct Due {
    time::Timestamp stamp{};
    std::int64_t number = 0;
    auto operator<=>(const Due&) const = default;  // NOLINT: clang-tidy 14 sees a null here
  };

  [[nodiscard]] Sender new_sender();
  [[nodiscard]] bool send(const Sender& sender, const std::string& channel,
                          std::span<const std::byte> bytes);
  void listen(LoopBus* owner, const std::string& channel, Bus::BytesHandler handler);
  void leave(const LoopBus* owner);
  [[nodiscard]] time::Duration jitter();

  LogWriter log_;
  bool log_complete_ = true;
  LoopDelay delay_;
  std::mt19937_64 engine_;
  time::Moment now_;
  std::int64_t num_deliveries_ = 0;
  std::uint16_t num_senders_ = 0;
  std::map<Due, Delivery> deliveries_;
  // Lists, because deliveries point to listeners.
  std::map<std::string, std::list<Listener>, std::less<>> listeners_;
};

/// The bus of one process on a LoopNetwork, which must outlive it. It is a sender of its own, as a
/// process with its socket is. Its destructor ends its subscriptions; do not destroy it within a
/// handler.
class LoopBus : public Bus {
 public:
  explicit LoopBus(LoopNetwork& network) : network_(network), sender_(network.new_sender()) {}
  ~LoopBus() override { network_.leave(this); }

 private:
  bool send(const std::string& channel, std::span<const std::byte> bytes) override {
    return network_.send(sender_, channel, bytes);
  }
  void listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) override {
    network_.listen(this, channel, std::move(handler));
  }

  friend class LoopNetwork;

  LoopNetwork& network_;
  Sender sender_;
  time::Timestamp last_due_{};
};

}  // namespace nodmap::bus
