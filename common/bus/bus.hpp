// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/latency.hpp"

namespace nodmap::bus {

/// What went over a bus since it was made.
struct BusCounts {
  std::int64_t received = 0;  ///< messages handed to a handler
  std::int64_t corrupt = 0;   ///< messages and datagrams that were no valid ones, and dropped
  std::int64_t published = 0;
  std::int64_t not_published = 0;  ///< refused by the transport: too large, no route, disk full
  std::int64_t overrun = 0;  ///< messages that came faster than they were handled, and dropped
  std::int64_t refused = 0;  ///< datagrams of hosts that are not trusted, and dropped
  std::string refused_host;  ///< address of the last of them; empty: none
};

/// Where messages come from and go to. The one interface a node sees; live and replay differ only
/// in which bus it is given. Not thread safe: one bus belongs to one thread.
class Bus : private boost::noncopyable {
 public:
  using BytesHandler = std::function<void(std::span<const std::byte>)>;

  /// More than the bursts of any of our publishers; a reader that falls this far behind has a
  /// problem that a longer queue would hide.
  static constexpr int kDefaultQueue = 64;

  virtual ~Bus() = default;

  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    encode_into(encode_buffer_, message);
    count_publish(send(channel, encode_buffer_));
  }

  /// Bytes as they are, for what forwards messages without looking into them.
  void publish_bytes(const std::string& channel, std::span<const std::byte> bytes) {
    count_publish(send(channel, bytes));
  }

  /// Calls `handler` for each valid message on exactly this channel; an invalid one is counted and
  /// dropped. `handler` may throw: the exception comes out of the bus's handle(), never through
  /// LCM.
  template <class Message, class Handler>
  void subscribe(const std::string& channel, Handler handler, int queue_capacity = kDefaultQueue) {
    // The message is kept between calls, so that its vectors are allocated once.
    subscribe_bytes(
        channel,
        [this, handler = std::move(handler),
         message = std::make_shared<Message>()](std::span<const std::byte> bytes) mutable {
          if (!decode_into(*message, bytes)) {
            ++counts_.corrupt;
            return;
          }
          ++counts_.received;
          const LatencyMeter::Scope measured(latency_);
          handler(std::as_const(*message));
        },
        queue_capacity);
  }

  /// Messages as they are on exactly this channel.
  void subscribe_bytes(const std::string& channel, BytesHandler handler,
                       int queue_capacity = kDefaultQueue) {
    listen(channel, std::move(handler), queue_capacity);
  }

  [[nodiscard]] virtual BusCounts counts() const { return counts_; }

  /// How long handlers took. Wall clock: for reports, never for results.
  [[nodiscard]] LatencyMeter& latency() { return latency_; }

 protected:
  /// Hands bytes to the transport; false when it refuses them.
  virtual bool send(const std::string& channel, std::span<const std::byte> bytes) = 0;
  virtual void listen(const std::string& channel, BytesHandler handler, int queue_capacity) = 0;
  void count_received() { ++counts_.received; }

 private:
  void count_publish(bool sent) { ++(sent ? counts_.published : counts_.not_published); }

  BusCounts counts_;
  LatencyMeter latency_;
  std::vector<std::byte> encode_buffer_;
};

/// A reader that wants only the newest message of a channel. The queues of memq:// and of other
/// providers drop the NEWEST when they are full, so a short queue is no "latest only": this takes
/// everything and keeps the last.
template <class Message>
class Latest {
 public:
  Latest(Bus& bus, const std::string& channel) : state_(std::make_shared<State>()) {
    bus.subscribe<Message>(channel, [state = state_](const Message& message) {
      state->message = message;
      ++state->count;
    });
  }

  /// The newest message so far, if any.
  [[nodiscard]] const std::optional<Message>& get() const { return state_->message; }
  /// How many have come.
  [[nodiscard]] std::int64_t count() const { return state_->count; }

 private:
  struct State {
    std::optional<Message> message;
    std::int64_t count = 0;
  };
  std::shared_ptr<State> state_;  // shared with the subscription, which may outlive this reader
};

}  // namespace nodmap::bus
