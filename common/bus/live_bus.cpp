// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/live_bus.hpp"

#include <algorithm>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <list>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace nodmap::bus {
namespace {

// After so many messages in a row handle() returns to its caller even if more are waiting.
constexpr int kMaxPerHandle = 1000;

std::span<const std::byte> bytes_of(const lcm::ReceiveBuffer& buffer) {
  return std::as_bytes(
      std::span(static_cast<const char*>(buffer.data), static_cast<std::size_t>(buffer.data_size)));
}

}  // namespace

std::string resolve_url(const std::string& url) {
  if (!url.empty()) {
    return url;
  }
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");  // NOLINT(concurrency-mt-unsafe)
  if (from_environment != nullptr && *from_environment != '\0') {
    return from_environment;
  }
  return "udpm://239.255.76.67:7667?ttl=0";
}

std::string literal_channel(const std::string& channel) {
  std::string escaped;
  for (const char c : channel) {
    if (std::string_view(R"(\^$.|?*+()[]{})").find(c) != std::string_view::npos) {
      escaped += '\\';
    }
    escaped += c;
  }
  return escaped;
}

struct LiveBus::Impl {
  explicit Impl(const std::string& url) : lcm(url) {}

  struct Listener {
    Impl* owner;
    AnyHandler handler;

    /// Called by LCM's C code: nothing may be thrown out of here, or the next handle() aborts.
    // LCM takes pointers to non-const members only.
    // NOLINTNEXTLINE(readability-make-member-function-const)
    void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      try {
        handler({channel, bytes_of(*buffer), buffer->recv_utime});
      } catch (...) {
        if (!owner->thrown) {
          owner->thrown = std::current_exception();
        }
      }
    }
  };

  void listen(const std::string& channel_regex, AnyHandler handler, int queue_capacity) {
    listeners.push_back({this, std::move(handler)});
    lcm::Subscription* subscription =
        lcm.subscribe(channel_regex, &Listener::receive, &listeners.back());
    // 0 would mean without bound.
    subscription->setQueueCapacity(std::max(1, queue_capacity));
  }

  lcm::LCM lcm;
  std::list<Listener> listeners;  // LCM keeps pointers to them
  std::exception_ptr thrown;
};

LiveBus::LiveBus(const std::string& url)
    : url_(resolve_url(url)), impl_(std::make_unique<Impl>(url_)) {
  if (!impl_->lcm.good()) {
    throw std::runtime_error("LCM cannot use " + url_ +
                             " (is there a multicast route? nodmap-doctor tells)");
  }
}

LiveBus::~LiveBus() = default;

int LiveBus::handle(std::chrono::milliseconds timeout) {
  int handled = 0;
  int wait_ms = static_cast<int>(timeout.count());
  while (handled < kMaxPerHandle && impl_->lcm.handleTimeout(wait_ms) > 0) {
    wait_ms = 0;
    ++handled;
    if (impl_->thrown) {
      std::rethrow_exception(std::exchange(impl_->thrown, nullptr));
    }
  }
  return handled;
}

void LiveBus::subscribe_all(AnyHandler handler, int queue_capacity) {
  impl_->listen(
      ".*",
      [this, handler = std::move(handler)](const RawMessage& message) {
        count_received();
        const LatencyMeter::Scope measured(latency());
        handler(message);
      },
      queue_capacity);
}

bool LiveBus::send(const std::string& channel, std::span<const std::byte> bytes) {
  return impl_->lcm.publish(channel, bytes.data(), static_cast<unsigned int>(bytes.size())) == 0;
}

void LiveBus::listen(const std::string& channel, BytesHandler handler, int queue_capacity) {
  impl_->listen(
      literal_channel(channel),
      [handler = std::move(handler)](const RawMessage& message) { handler(message.data); },
      queue_capacity);
}

}  // namespace nodmap::bus
