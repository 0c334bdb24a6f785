// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/udpm_receiver.hpp"

#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <deque>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/arrival_clock.hpp"
#include "common/bus/datagram_batch.hpp"
#include "common/bus/message_assembler.hpp"
#include "common/bus/multicast_socket.hpp"
#include "common/bus/trusted_hosts.hpp"
#include "common/geometry/clock.hpp"

namespace nodmap::bus {
namespace {

// The number of batches read in a row while none contains a wanted message: bounds how long a flood
// can keep the caller.
constexpr int kMaxBatches = 100;

}  // namespace

struct UdpmReceiver::Impl {
  struct Subscription {
    std::optional<std::string> channel;
    RawHandler handler;
    std::size_t capacity = 1;
    std::size_t num_queued = 0;

    [[nodiscard]] bool receives(std::string_view name) const {
      return !channel || *channel == name;
    }
  };
  struct Queued {
    Subscription* subscription = nullptr;
    std::string channel;
    std::shared_ptr<const std::byte[]>
        bytes;  // NOLINT(modernize-avoid-c-arrays): sized at run time
    std::size_t size = 0;
    Origin origin;
  };

  Impl(const UdpmUrl& its_url, const std::string& trusted_hosts)
      : url(its_url),
        hosts(trusted_hosts),
        assembler([this](std::string_view channel) { return is_wanted(channel); }) {}

  ~Impl() {
    if (thread.joinable()) {
      ::eventfd_write(stop.get(), 1);
      thread.join();
    }
  }

  void start() {
    socket = open_multicast_socket(url);
    // The new thread blocks all signals, so that the thread that created it gets them.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    thread = std::thread([this] { receive_until_stopped(); });
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  void receive_until_stopped() {
    std::array<pollfd, 2> entries{{{socket.get(), POLLIN, 0}, {stop.get(), POLLIN, 0}}};
    while (entries[1].revents == 0) {
      if (::poll(entries.data(), entries.size(), -1) > 0 && entries[0].revents != 0) {
        const std::lock_guard lock(mutex);
        (void)take_batch();
      }
    }
  }

  // Receives what waits in the socket, because the thread may not have run yet. Returns whether
  // any message now waits for its handler.
  bool catch_up() {
    const std::lock_guard lock(mutex);
    for (int i = 0; i < kMaxBatches && socket.is_open() && queue.empty() && take_batch() > 0; ++i) {
    }
    return !queue.empty();
  }

  // Moves datagrams from the socket into the queue without blocking and returns their number. The
  // mutex must be locked, so that each datagram is seen either in the socket or in the queue.
  std::size_t take_batch() {
    const time::Moment now{time::SystemClock().now(), time::steady_now()};
    arrivals.begin(now);
    const auto count = static_cast<std::size_t>(std::max(0, batch.receive(socket.get())));
    const bool was_empty = queue.empty();
    for (std::size_t i = 0; i < count; ++i) {
      const Sender sender = batch.sender(i);
      if (!hosts.contains(sender.address, now.steady)) {
        ++counts.refused;
        refused_address = sender.address;
        continue;
      }
      if (const auto message = assembler.take(sender, batch.datagram(i))) {
        const time::Timestamp received = batch.received(i);
        enqueue(*message, {sender, received, arrivals.arrival(received)});
      }
    }
    if (count < DatagramBatch::kBatch) {
      arrivals.drained();
    }
    if (count > 0) {
      const std::uint32_t dropped = batch.num_dropped(count - 1);
      counts.overrun += std::uint32_t{dropped - last_dropped};
      last_dropped = dropped;
    }
    counts.malformed = assembler.malformed();
    if (was_empty && !queue.empty()) {
      ::eventfd_write(waiting.get(), 1);
    }
    return count;
  }

  [[nodiscard]] bool is_wanted(std::string_view channel) const {
    return std::ranges::any_of(
        subscriptions, [channel](const Subscription& each) { return each.receives(channel); });
  }

  // Queues a message for each subscription to its channel; they share one copy of the bytes.
  void enqueue(const MessageAssembler::Message& message, const Origin& origin) {
    const std::size_t size = message.data.size();
    std::shared_ptr<std::byte[]> bytes;  // NOLINT(modernize-avoid-c-arrays): sized at run time
    for (Subscription& each : subscriptions) {
      if (!each.receives(message.channel)) {
        continue;
      }
      if (each.num_queued >= each.capacity) {
        drop_oldest(each);
      }
      if (queued_bytes + size > kMaxQueuedBytes) {
        ++counts.overrun;
        continue;
      }
      if (!bytes) {
        bytes =
            std::make_shared_for_overwrite<std::byte[]>(size);  // NOLINT(modernize-avoid-c-arrays)
        std::ranges::copy(message.data, bytes.get());
      }
      ++each.num_queued;
      queued_bytes += size;
      queue.push_back({&each, std::string(message.channel), bytes, size, origin});
    }
  }

  void drop_oldest(Subscription& subscription) {
    const auto oldest = std::ranges::find(queue, &subscription, &Queued::subscription);
    queued_bytes -= oldest->size;
    queue.erase(oldest);
    --subscription.num_queued;
    ++counts.overrun;
  }

  std::optional<Queued> next() {
    const std::lock_guard lock(mutex);
    if (queue.empty()) {
      return std::nullopt;
    }
    Queued first = std::move(queue.front());
    queue.pop_front();
    --first.subscription->num_queued;
    queued_bytes -= first.size;
    if (queue.empty()) {
      eventfd_t value = 0;
      ::eventfd_read(waiting.get(), &value);
    }
    return first;
  }

  UdpmUrl url;
  formats::FileDescriptor waiting{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd"};
  formats::FileDescriptor stop{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd"};
  formats::FileDescriptor socket;  // none before the first subscription

  std::mutex mutex;  // guards the members below
  DatagramBatch batch;
  ArrivalClock arrivals{time::steady_now()};
  TrustedHosts hosts;
  MessageAssembler assembler;
  std::list<Subscription> subscriptions;  // the queue keeps pointers to them
  std::deque<Queued> queue;
  std::size_t queued_bytes = 0;
  ReceiverCounts counts;
  std::uint32_t refused_address = 0;
  std::uint32_t last_dropped = 0;

  std::thread thread;  // declared last: joined before anything it uses is destroyed
};

UdpmReceiver::UdpmReceiver(const UdpmUrl& url, const std::string& trusted_hosts)
    : impl_(std::make_unique<Impl>(url, trusted_hosts)) {}

UdpmReceiver::~UdpmReceiver() = default;

void UdpmReceiver::subscribe(std::optional<std::string> channel, RawHandler handler,
                             int queue_capacity) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->subscriptions.push_back(
        {.channel = std::move(channel),
         .handler = std::move(handler),
         .capacity = static_cast<std::size_t>(std::max(1, queue_capacity)),
         .num_queued = 0});
  }
  if (!impl_->socket.is_open()) {
    impl_->start();
  }
}

int UdpmReceiver::handle(std::chrono::milliseconds timeout, HandleLimit limit) {
  pollfd entry{impl_->waiting.get(), POLLIN, 0};
  if (::poll(&entry, 1, static_cast<int>(timeout.count())) <= 0 && !impl_->catch_up()) {
    return 0;
  }
  int handled = 0;
  while (limit.admits_another()) {
    const std::optional<Impl::Queued> message = impl_->next();
    if (!message) {
      break;
    }
    ++handled;
    message->subscription->handler({message->channel,
                                    {message->bytes.get(), message->size},
                                    message->origin.received,
                                    message->origin.sender,
                                    message->origin.arrived});
  }
  return handled;
}

int UdpmReceiver::poll_handle() const {
  return impl_->waiting.get();
}

ReceiverCounts UdpmReceiver::counts() const {
  const std::lock_guard lock(impl_->mutex);
  ReceiverCounts counts = impl_->counts;
  if (counts.refused > 0) {
    counts.refused_host = address_text(impl_->refused_address);
  }
  return counts;
}

}  // namespace nodmap::bus
