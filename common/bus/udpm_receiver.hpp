// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/bus/sender.hpp"
#include "common/bus/udpm_url.hpp"
#include "common/geometry/clock.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// A message as received, not decoded.
struct RawMessage {
  std::string channel;
  std::span<const std::byte> data;  ///< valid during the call
  time::Timestamp received{};       ///< when this host received it, before it was queued
  Sender sender{};
  time::SteadyTime arrived{};  ///< the same by the steady clock; see Origin
};
using RawHandler = std::function<void(const RawMessage&)>;

/// How much one handle() does, so that its caller can also do something else while messages come
/// faster than they are handled.
class HandleLimit {
 public:
  static constexpr int kMaxMessages = 1000;
  static constexpr time::Duration kMaxTime = 50ms;  ///< in handlers

  /// Counts a message and returns whether it may be handled. The first one always may: time counts
  /// from then on.
  [[nodiscard]] bool admits_another(time::SteadyTime now = time::steady_now()) {
    end_ = num_messages_ == 0 ? now + kMaxTime : end_;
    return now < end_ && num_messages_++ < kMaxMessages;
  }

 private:
  int num_messages_ = 0;
  time::SteadyTime end_;
};

/// Numbers of messages and datagrams that a receiver did not deliver.
struct ReceiverCounts {
  std::int64_t malformed = 0;  ///< datagrams that are not LCM's
  std::int64_t refused = 0;    ///< datagrams of hosts that are not trusted
  std::int64_t overrun = 0;    ///< messages dropped because a queue or the socket's buffer was full
  std::string refused_host;    ///< address of the last one refused; empty: none
};

/// Receives LCM's UDP multicast instead of liblcm, which two datagrams can crash (1.3.1 and 1.5.2),
/// because it adds fragment offset and size in 32 bits. MessageAssembler describes the checks.
///
/// A thread reads datagrams from the socket as they arrive, so a slow handler fills a queue here
/// and not the socket's buffer. Handlers run in handle() only. Each subscription has a queue of the
/// requested capacity. When it is full, its oldest message is dropped, so that a process that has
/// fallen behind continues with recent messages; when all queues together hold kMaxQueuedBytes, the
/// new message is dropped. The socket is opened with the first subscription and bound to the
/// multicast group. (LCM binds to every address, and so also receives other groups and unicast on
/// its port.)
class UdpmReceiver : private boost::noncopyable {
 public:
  static constexpr std::size_t kMaxQueuedBytes = std::size_t{64} << 20U;

  /// `trusted_hosts`: see TrustedHosts.
  UdpmReceiver(const UdpmUrl& url, const std::string& trusted_hosts);
  ~UdpmReceiver();

  /// Subscribes to a channel, or to all. Throws std::system_error if the socket cannot be opened.
  void subscribe(std::optional<std::string> channel, RawHandler handler, int queue_capacity);

  /// Waits up to `timeout` for a message, then delivers the waiting messages within `limit`, and
  /// returns their number. At the end of the wait it also reads the socket itself: 0 means that
  /// this host has received no message, not that the thread was late. Rethrows the exception of a
  /// handler.
  int handle(std::chrono::milliseconds timeout, HandleLimit limit);

  /// A descriptor that is readable while a message waits.
  [[nodiscard]] int poll_handle() const;

  [[nodiscard]] ReceiverCounts counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace nodmap::bus
