// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/udpm_receiver.hpp"

namespace nodmap::bus {

/// The LCM provider URL to use: `url`, else $LCM_DEFAULT_URL, else multicast that stays on this
/// host (ttl=0).
[[nodiscard]] std::string resolve_url(const std::string& url);

/// The bus on a network (or memq://, within this object only). For udpm://, UdpmReceiver receives
/// the messages of this host and of the hosts in $NODMAP_TRUSTED_HOSTS ("10.0.0.2,10.0.1.0/24").
/// liblcm does everything else.
class LiveBus : public Bus {
 public:
  /// Longer messages are delivered only to subscribe_all(). Messages of package nodmap are hardly
  /// larger than 64 KiB, those of the process manager smaller than this.
  static constexpr std::size_t kMaxMessageBytes = std::size_t{256} << 10U;

  /// Throws formats::UserError if the URL, or $NODMAP_TRUSTED_HOSTS, is not well-formed;
  /// std::runtime_error, naming the URL and what to try, when LCM cannot use it.
  explicit LiveBus(const std::string& url);
  ~LiveBus() override;

  /// Waits up to `timeout` for a message, then handles the waiting messages and returns their
  /// number. Their number and the time it takes are limited (HandleLimit), so that the caller is
  /// never kept for long. Rethrows the exception of a handler after LCM has returned in a
  /// consistent state. Throws std::runtime_error if LCM has no connection to its server (tcpq).
  int handle(std::chrono::milliseconds timeout);

  /// A descriptor that is readable while a message waits, for loops that also wait for other
  /// descriptors; then call handle(0). Throws as handle().
  [[nodiscard]] int poll_handle();

  using RawMessage = bus::RawMessage;

  /// Subscribes to every channel without decoding the messages: for a logger.
  void subscribe_all(RawHandler handler, int queue_capacity);

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
