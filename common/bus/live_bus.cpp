// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/live_bus.hpp"

#include <lcm/lcm.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <list>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/formats/user_error.hpp"
#include "common/geometry/clock.hpp"

namespace nodmap::bus {
namespace {

std::string from_environment(const char* name) {
  const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
  return text != nullptr ? text : "";
}

// A regular expression that matches exactly this channel name. LCM interprets the name given to
// subscribe as an (anchored) regular expression: "LASER.1" would also match "LASER_1".
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

struct LcmDeleter {
  void operator()(lcm_t* lcm) const { ::lcm_destroy(lcm); }
};

}  // namespace

std::string resolve_url(const std::string& url) {
  const std::string wanted = url.empty() ? from_environment("LCM_DEFAULT_URL") : url;
  return wanted.empty() ? "udpm://239.255.76.67:7667?ttl=0" : wanted;
}

// Uses LCM's C interface. Its C++ interface casts a pointer to a class that the object is not an
// instance of, which UBSan rightly reports.
struct LiveBus::Impl {
  explicit Impl(const std::string& url) {
    const std::optional<UdpmUrl> udpm = parse_udpm_url(url);
    if (!udpm && url.starts_with("udpm:")) {
      throw formats::UserError(url +
                               " is not a valid LCM URL; example: udpm://239.255.76.67:7667?ttl=0");
    }
    if (udpm) {
      receiver.emplace(*udpm, from_environment("NODMAP_TRUSTED_HOSTS"));
    }
    lcm.reset(::lcm_create(url.c_str()));
    if (!lcm) {
      throw std::runtime_error("LCM cannot use " + url +
                               " (is there a multicast route? run nodmap-doctor)");
    }
  }

  struct Listener {
    Impl* owner;
    RawHandler handler;
  };

  // Called by LCM's C code. Must not throw: if it did, the next handle() would abort.
  static void receive(const lcm_recv_buf_t* buffer, const char* channel, void* user) noexcept {
    const auto* listener = static_cast<const Listener*>(user);
    try {
      const auto data = std::as_bytes(
          std::span(static_cast<const char*>(buffer->data), std::size_t{buffer->data_size}));
      listener->handler(
          {channel, data, time::from_utime(buffer->recv_utime), {}, time::steady_now()});
    } catch (...) {
      if (!listener->owner->thrown) {
        listener->owner->thrown = std::current_exception();
      }
    }
  }

  // Subscribes to a channel, or to all channels if `channel` is empty.
  void listen(const std::optional<std::string>& channel, RawHandler handler, int queue_capacity) {
    if (receiver) {
      receiver->subscribe(channel, std::move(handler), queue_capacity);
      return;
    }
    listeners.push_back({this, std::move(handler)});
    const std::string regex = channel ? literal_channel(*channel) : ".*";
    lcm_subscription_t* subscription =
        ::lcm_subscribe(lcm.get(), regex.c_str(), &receive, &listeners.back());
    // 0 would mean unlimited.
    ::lcm_subscription_set_queue_capacity(subscription, std::max(1, queue_capacity));
  }

  // The descriptor to wait for. Throws if there is none, because a server (tcpq) is missing or has
  // ended.
  [[nodiscard]] int poll_handle(const std::string& url) const {
    const int handle = ::lcm_get_fileno(lcm.get());
    if (handle < 0) {
      throw std::runtime_error("LCM has no connection to " + url);
    }
    return handle;
  }

  // Waits for a message.
  void wait(std::chrono::milliseconds timeout, const std::string& url) const {
    pollfd entry{poll_handle(url), POLLIN, 0};
    ::poll(&entry, 1, static_cast<int>(timeout.count()));
  }

  // Handles a message that has come. Returns false if none has.
  bool handle_one(const std::string& url) const {
    (void)poll_handle(url);  // without a descriptor, LCM would abort
    return ::lcm_handle_timeout(lcm.get(), 0) > 0;
  }

  std::int64_t too_large = 0;
  std::list<Listener> listeners;  // LCM keeps pointers to them
  std::exception_ptr thrown;
  std::unique_ptr<lcm_t, LcmDeleter> lcm;
  std::optional<UdpmReceiver> receiver;
};

LiveBus::LiveBus(const std::string& url)
    : url_(resolve_url(url)), impl_(std::make_unique<Impl>(url_)) {}

LiveBus::~LiveBus() = default;

int LiveBus::handle(std::chrono::milliseconds timeout) {
  if (impl_->receiver) {
    return impl_->receiver->handle(timeout, HandleLimit());
  }
  impl_->wait(timeout, url_);
  HandleLimit limit;  // of the time in handlers, without the wait
  int handled = 0;
  while (limit.admits_another() && impl_->handle_one(url_)) {
    ++handled;
    if (impl_->thrown) {
      std::rethrow_exception(std::exchange(impl_->thrown, nullptr));
    }
  }
  return handled;
}

int LiveBus::poll_handle() {
  return impl_->receiver ? impl_->receiver->poll_handle() : impl_->poll_handle(url_);
}

BusCounts LiveBus::counts() const {
  BusCounts counts = Bus::counts();
  counts.corrupt += impl_->too_large;
  if (impl_->receiver) {
    ReceiverCounts receiver = impl_->receiver->counts();
    counts.corrupt += receiver.malformed;
    counts.overrun = receiver.overrun;
    counts.refused = receiver.refused;
    counts.refused_host = std::move(receiver.refused_host);
  }
  return counts;
}

void LiveBus::subscribe_all(RawHandler handler, int queue_capacity) {
  impl_->listen(
      std::nullopt,
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
      channel,
      [this, handler = std::move(handler)](const RawMessage& message) {
        if (message.data.size() > kMaxMessageBytes) {
          ++impl_->too_large;
          return;
        }
        set_origin({message.sender, message.received, message.arrived});
        handler(message.data);
      },
      queue_capacity);
}

}  // namespace nodmap::bus
