// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/live_bus.hpp"

#include <lcm/lcm.h>

#include <algorithm>
#include <cstdlib>
#include <list>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace nodmap::bus {
namespace {

// After so many messages in a row handle() returns to its caller even if more are waiting.
constexpr int kMaxPerHandle = 1000;

struct LcmDeleter {
  void operator()(lcm_t* lcm) const { ::lcm_destroy(lcm); }
};

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

// LCM's C interface, because its C++ one casts a pointer to a class of which it made no object, and
// UBSan rightly stops there.
struct LiveBus::Impl {
  explicit Impl(const std::string& url) : lcm(::lcm_create(url.c_str())) {}

  struct Listener {
    Impl* owner;
    AnyHandler handler;
  };

  /// Called by LCM's C code: nothing may be thrown out of here, or the next handle() aborts.
  static void receive(const lcm_recv_buf_t* buffer, const char* channel, void* user) noexcept {
    const auto* listener = static_cast<const Listener*>(user);
    try {
      const auto data = std::as_bytes(
          std::span(static_cast<const char*>(buffer->data), std::size_t{buffer->data_size}));
      listener->handler({channel, data, buffer->recv_utime});
    } catch (...) {
      if (!listener->owner->thrown) {
        listener->owner->thrown = std::current_exception();
      }
    }
  }

  void listen(const std::string& channel_regex, AnyHandler handler, int queue_capacity) {
    listeners.push_back({this, std::move(handler)});
    lcm_subscription_t* subscription =
        ::lcm_subscribe(lcm.get(), channel_regex.c_str(), &receive, &listeners.back());
    // 0 would mean without bound.
    ::lcm_subscription_set_queue_capacity(subscription, std::max(1, queue_capacity));
  }

  std::list<Listener> listeners;  // LCM keeps pointers to them
  std::exception_ptr thrown;
  std::unique_ptr<lcm_t, LcmDeleter> lcm;  // ends first
};

LiveBus::LiveBus(const std::string& url)
    : url_(resolve_url(url)), impl_(std::make_unique<Impl>(url_)) {
  if (!impl_->lcm) {
    throw std::runtime_error("LCM cannot use " + url_ +
                             " (is there a multicast route? nodmap-doctor tells)");
  }
}

LiveBus::~LiveBus() = default;

int LiveBus::handle(std::chrono::milliseconds timeout) {
  int handled = 0;
  int wait_ms = static_cast<int>(timeout.count());
  while (handled<kMaxPerHandle&& ::lcm_handle_timeout(impl_->lcm.get(), wait_ms)> 0) {
    wait_ms = 0;
    ++handled;
    if (impl_->thrown) {
      std::rethrow_exception(std::exchange(impl_->thrown, nullptr));
    }
  }
  return handled;
}

int LiveBus::poll_handle() {
  return ::lcm_get_fileno(impl_->lcm.get());
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
  return ::lcm_publish(impl_->lcm.get(), channel.c_str(), bytes.data(),
                       static_cast<unsigned int>(bytes.size())) == 0;
}

void LiveBus::listen(const std::string& channel, BytesHandler handler, int queue_capacity) {
  impl_->listen(
      literal_channel(channel),
      [handler = std::move(handler)](const RawMessage& message) { handler(message.data); },
      queue_capacity);
}

}  // namespace nodmap::bus
