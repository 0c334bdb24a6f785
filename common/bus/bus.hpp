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
#include "common/bus/sender.hpp"

namespace nodmap::bus {

/// Message counts of a bus since its construction.
struct BusCounts {
  std::int64_t received = 0;  ///< messages handed to a handler
  std::int64_t corrupt = 0;   ///< invalid messages and datagrams, dropped
  std::int64_t published = 0;
  std::int64_t not_published = 0;  ///< refused by the transport: too large, no route, disk full
  std::int64_t overrun = 0;        ///< messages dropped because the process was too slow
  std::int64_t refused = 0;        ///< datagrams dropped because their sender is not trusted
  std::string refused_host;        ///< address of the last refused sender; empty: none
};

/// The interface through which a node subscribes and publishes. Live operation and replay differ
/// only in the implementation of this interface. Not thread safe: a bus belongs to one thread.
class Bus : private boost::noncopyable {
 public:
  using BytesHandler = std::function<void(std::span<const std::byte>)>;

  /// Default queue capacity, in messages: longer than the bursts of any of our publishers. A
  /// subscriber that falls farther behind has a problem that a longer queue would only hide.
  static constexpr int kDefaultQueue = 64;

  virtual ~Bus() = default;

  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    encode_into(encode_buffer_, message);
    count_publish(send(channel, encode_buffer_));
  }

  /// Publishes encoded bytes unchanged, for programs that forward messages without decoding them.
  void publish_bytes(const std::string& channel, std::span<const std::byte> bytes) {
    count_publish(send(channel, bytes));
  }

  /// Calls `handler` for each valid message on exactly this channel; an invalid one is counted and
  /// dropped. The subscription lasts as long as the bus, so everything that `handler` refers to
  /// must outlive the bus. `handler` may throw: the exception comes out of the bus's handle(),
  /// never through LCM.
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

  /// Calls `handler` with the encoded bytes of each message on exactly this channel.
  void subscribe_bytes(const std::string& channel, BytesHandler handler,
                       int queue_capacity = kDefaultQueue) {
    listen(channel, std::move(handler), queue_capacity);
  }

  /// Where the message being handled came from.
  [[nodiscard]] const Origin& origin() const { return origin_; }

  [[nodiscard]] virtual BusCounts counts() const { return counts_; }

  /// Durations of the handlers, by the wall clock: for reports only, never for results.
  [[nodiscard]] LatencyMeter& latency() { return latency_; }

 protected:
  /// Passes bytes to the transport; false if it refuses them.
  virtual bool send(const std::string& channel, std::span<const std::byte> bytes) = 0;
  virtual void listen(const std::string& channel, BytesHandler handler, int queue_capacity) = 0;
  void count_received() { ++counts_.received; }
  void set_origin(const Origin& origin) { origin_ = origin; }

 private:
  void count_publish(bool sent) { ++(sent ? counts_.published : counts_.not_published); }

  BusCounts counts_;
  Origin origin_;
  LatencyMeter latency_;
  std::vector<std::byte> encode_buffer_;
};

/// Subscribes to a channel and keeps only its newest message. A short queue would not do that,
/// because the queues of memq:// and other providers drop the NEWEST message when they are full.
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
  /// Number of messages received.
  [[nodiscard]] std::int64_t count() const { return state_->count; }

 private:
  struct State {
    std::optional<Message> message;
    std::int64_t count = 0;
  };
  std::shared_ptr<State> state_;  // shared with the subscription, which may outlive this reader
};

}  // namespace nodmap::bus
