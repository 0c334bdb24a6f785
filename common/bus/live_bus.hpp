// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/udpm_receiver.hpp"

namespace nodmap::bus {

/// The LCM provider URL to use: `url`, else $LCM_DEFAULT_URL, else multicast that stays on this
/// host (ttl=0).
[[nodiscard]] std::string resolve_url(const std::string& url);

/// A channel name as the regular expression that matches it and nothing else: LCM takes the name
/// given to subscribe for an (anchored) regular expression, so that "LASER.1" would also match
/// "LASER_1".
[[nodiscard]] std::string literal_channel(const std::string& channel);

/// The bus on a network (or memq://, within this object only). udpm:// is received by UdpmReceiver:
/// from this host, and from those that $NODMAP_TRUSTED_HOSTS names ("10.0.0.2,10.0.1.0/24"). All
/// the rest is liblcm's.
class LiveBus : public Bus {
 public:
  /// Longer messages reach nobody but who subscribes to all: ours stay under 64 KiB, and those of
  /// the process manager under this.
  static constexpr std::size_t kMaxMessageBytes = std::size_t{256} << 10U;

  /// Throws std::runtime_error, naming the URL and what to try, when LCM cannot use it.
  explicit LiveBus(const std::string& url);
  ~LiveBus() override;

  /// Waits up to `timeout` for a message, then handles all that are waiting (bounded, so that a
  /// flood cannot keep the caller for ever). Returns how many. An exception from a handler comes
  /// out here, after LCM has been left in order.
  int handle(std::chrono::milliseconds timeout);

  /// Readable when a message waits, for a loop that also watches other descriptors; then call
  /// handle(0).
  [[nodiscard]] int poll_handle();

  using RawMessage = bus::RawMessage;
  using AnyHandler = RawHandler;

  /// Hears every channel, without decoding: for a logger.
  void subscribe_all(AnyHandler handler, int queue_capacity);

  [[nodiscard]] BusCounts counts() const override;

  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  struct Impl;

  bool send(const std::string& channel, std::span<const std::byte> bytes) override;
  void listen(const std::string& channel, BytesHandler handler, int queue_capacity) override;

  std::string url_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace nodmap::bus
