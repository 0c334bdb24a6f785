// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/bus/udpm_url.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// A message as it came.
struct RawMessage {
  std::string channel;
  std::span<const std::byte> data;  ///< valid during the call
  time::Timestamp received{};       ///< when this host received it, before it was queued
};
using RawHandler = std::function<void(const RawMessage&)>;

/// What a receiver did not hand over.
struct ReceiverCounts {
  std::int64_t malformed = 0;  ///< datagrams that are not LCM's
  std::int64_t refused = 0;    ///< datagrams of hosts that are not trusted
  std::int64_t overrun = 0;    ///< messages for which a queue had no room, or the socket's buffer
  std::string refused_host;    ///< address of the last one refused; empty: none
};

/// Receives LCM's UDP multicast in place of liblcm, which two datagrams can crash (1.3.1, and 1.5.2
/// too): fragment offset and size are added in 32 bits. See MessageAssembler for what is checked.
///
/// A thread takes datagrams out of the socket as they come, so that a handler that takes long fills
/// a queue here and not the socket's buffer; handlers run in handle() alone. Each subscription
/// holds so many messages as was asked for, all together kMaxQueuedBytes; when its queue is full
/// its oldest message is dropped: a process that has fallen behind goes on with what is new. The
/// socket is opened with the first subscription, and bound to the multicast group: LCM binds to
/// every address, and so hears other groups, and single hosts, on its port.
class UdpmReceiver {
 public:
  static constexpr std::size_t kMaxQueuedBytes = std::size_t{64} << 20U;

  /// `trusted_hosts` as TrustedHosts takes it.
  UdpmReceiver(const UdpmUrl& url, const std::string& trusted_hosts);
  ~UdpmReceiver();
  UdpmReceiver(const UdpmReceiver&) = delete;
  UdpmReceiver& operator=(const UdpmReceiver&) = delete;
  UdpmReceiver(UdpmReceiver&&) = delete;
  UdpmReceiver& operator=(UdpmReceiver&&) = delete;

  /// Hears this channel, or every one. Throws std::system_error when there is no such socket.
  void subscribe(std::optional<std::string> channel, RawHandler handler, int queue_capacity);

  /// Waits up to `timeout` for a message, then hands over what waits, `max` at most. Returns how
  /// many. What a handler throws comes out here.
  int handle(std::chrono::milliseconds timeout, int max);

  /// Readable while a message waits.
  [[nodiscard]] int poll_handle() const;

  [[nodiscard]] ReceiverCounts counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace nodmap::bus
