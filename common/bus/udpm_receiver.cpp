// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/udpm_receiver.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <deque>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/message_assembler.hpp"
#include "common/bus/trusted_hosts.hpp"

namespace nodmap::bus {
namespace {

constexpr std::size_t kMaxDatagramBytes = 65'536;  // UDP's largest is shorter
constexpr std::size_t kBatch = 16;
// So many in a row, though none of it is wanted: a flood keeps nobody for long.
constexpr int kMaxBatches = 100;

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd, const char* what) : fd_(fd) {
    if (fd < 0) {
      throw std::system_error(errno, std::system_category(), what);
    }
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;
  ~FileDescriptor() {
    if (fd_ >= 0) {
      ::close(fd_);
    }
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

template <class Value>
void set_option(int socket, int level, int name, const Value& value, const char* what) {
  if (::setsockopt(socket, level, name, &value, sizeof(value)) != 0) {
    throw std::system_error(errno, std::system_category(), what);
  }
}

/// A socket that hears the group, with the kernel's time of arrival on each datagram.
FileDescriptor open_socket(const UdpmUrl& url) {
  FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), "socket");
  set_option(socket.get(), SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
  set_option(socket.get(), SOL_SOCKET, SO_TIMESTAMP, 1, "SO_TIMESTAMP");
  set_option(socket.get(), SOL_SOCKET, SO_RXQ_OVFL, 1, "SO_RXQ_OVFL");
  // Beyond net.core.rmem_max only with the right to; without it the kernel gives what it allows,
  // and nodmap-doctor tells.
  const int wanted = url.receive_buffer_bytes;
  if (::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof(wanted)) != 0) {
    set_option(socket.get(), SOL_SOCKET, SO_RCVBUF, wanted, "SO_RCVBUF");
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url.port);
  address.sin_addr.s_addr = std::bit_cast<std::uint32_t>(url.group);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the C interface wants it
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    throw std::system_error(errno, std::system_category(), "bind to " + url.group_text());
  }
  const ip_mreq membership{.imr_multiaddr = address.sin_addr, .imr_interface = {INADDR_ANY}};
  set_option(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, membership, "IP_ADD_MEMBERSHIP");
  return socket;
}

time::Timestamp wall_now() {
  return time::Timestamp(std::chrono::duration_cast<time::Duration>(
      std::chrono::system_clock::now().time_since_epoch()));
}

/// What the kernel says beside a datagram under `type`; nothing where it says nothing.
template <class Value>
std::optional<Value> read_control(msghdr& header, int type) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == type) {
      Value value{};
      std::memcpy(&value, CMSG_DATA(part), sizeof(value));
      return value;
    }
  }
  return std::nullopt;
}

/// Room for several datagrams, which one system call fills.
class DatagramBatch {
 public:
  /// Takes what waits in the socket, without waiting. How many.
  int receive(int socket) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      parts_[i] = {&bytes_[i * kMaxDatagramBytes], kMaxDatagramBytes};
      headers_[i].msg_hdr = {.msg_name = &from_[i],
                             .msg_namelen = sizeof(from_[i]),
                             .msg_iov = &parts_[i],
                             .msg_iovlen = 1,
                             .msg_control = control_[i].data(),
                             .msg_controllen = control_[i].size(),
                             .msg_flags = 0};
    }
    return ::recvmmsg(socket, headers_.data(), kBatch, MSG_DONTWAIT, nullptr);
  }

  [[nodiscard]] std::span<const std::byte> datagram(std::size_t i) const {
    return std::span(bytes_).subspan(i * kMaxDatagramBytes, headers_.at(i).msg_len);
  }
  [[nodiscard]] MessageAssembler::Sender sender(std::size_t i) const {
    return {ntohl(from_.at(i).sin_addr.s_addr), ntohs(from_.at(i).sin_port)};
  }
  /// The kernel's time of arrival; now, where it gave none.
  [[nodiscard]] time::Timestamp received(std::size_t i) {
    const auto stamp = read_control<timeval>(headers_.at(i).msg_hdr, SCM_TIMESTAMP);
    return stamp ? time::Timestamp(stamp->tv_sec * 1s + stamp->tv_usec * 1us) : wall_now();
  }
  /// Datagrams for which the socket's buffer had no room, since it was opened; they wrap at 2^32.
  [[nodiscard]] std::uint32_t num_dropped(std::size_t i) {
    return read_control<std::uint32_t>(headers_.at(i).msg_hdr, SO_RXQ_OVFL).value_or(0);
  }

 private:
  struct alignas(cmsghdr) Control : std::array<char, 64> {};

  std::vector<std::byte> bytes_ = std::vector<std::byte>(kBatch * kMaxDatagramBytes);
  std::array<sockaddr_in, kBatch> from_{};
  std::array<iovec, kBatch> parts_{};
  std::array<Control, kBatch> control_{};
  std::array<mmsghdr, kBatch> headers_{};
};

}  // namespace

struct UdpmReceiver::Impl {
  struct Subscription {
    std::optional<std::string> channel;
    RawHandler handler;
    std::size_t capacity = 1;
    std::size_t num_queued = 0;

    [[nodiscard]] bool hears(std::string_view name) const { return !channel || *channel == name; }
  };
  struct Queued {
    Subscription* subscription = nullptr;
    std::string channel;
    std::shared_ptr<const std::byte[]>
        bytes;  // NOLINT(modernize-avoid-c-arrays): sized at run time
    std::size_t size = 0;
    time::Timestamp received{};
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
    socket.emplace(open_socket(url));
    // Signals are for the thread that made this one.
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    thread = std::thread([this] { receive_until_stopped(); });
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  void receive_until_stopped() {
    std::array<pollfd, 2> entries{{{socket->get(), POLLIN, 0}, {stop.get(), POLLIN, 0}}};
    while (entries[1].revents == 0) {
      if (::poll(entries.data(), entries.size(), -1) > 0 && entries[0].revents != 0) {
        const std::lock_guard lock(mutex);
        (void)take_batch();
      }
    }
  }

  /// Takes what waits in the socket now, because the thread may not have had a processor yet.
  /// Whether any message waits for its handler then.
  bool catch_up() {
    const std::lock_guard lock(mutex);
    for (int i = 0; i < kMaxBatches && socket && queue.empty() && take_batch() > 0; ++i) {
    }
    return !queue.empty();
  }

  /// From the socket into the queue, without waiting; how many datagrams. With the mutex locked, so
  /// that each datagram is seen either in the socket or in the queue.
  std::size_t take_batch() {
    const auto count = static_cast<std::size_t>(std::max(0, batch.receive(socket->get())));
    const bool was_empty = queue.empty();
    const auto now = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < count; ++i) {
      const MessageAssembler::Sender sender = batch.sender(i);
      if (!hosts.contains(sender.address, now)) {
        ++counts.refused;
        refused_address = sender.address;
        continue;
      }
      if (const auto message = assembler.take(sender, batch.datagram(i))) {
        enqueue(*message, batch.received(i));
      }
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
    return std::ranges::any_of(subscriptions,
                               [channel](const Subscription& each) { return each.hears(channel); });
  }

  /// For each subscription that hears it; the bytes are there once.
  void enqueue(const MessageAssembler::Message& message, time::Timestamp received) {
    const std::size_t size = message.data.size();
    std::shared_ptr<std::byte[]> bytes;  // NOLINT(modernize-avoid-c-arrays): sized at run time
    for (Subscription& each : subscriptions) {
      if (!each.hears(message.channel)) {
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
      queue.push_back({&each, std::string(message.channel), bytes, size, received});
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
  FileDescriptor waiting{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd"};
  FileDescriptor stop{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd"};
  std::optional<FileDescriptor> socket;

  std::mutex mutex;  // guards what follows
  DatagramBatch batch;
  TrustedHosts hosts;
  MessageAssembler assembler;
  std::list<Subscription> subscriptions;  // the queue keeps pointers to them
  std::deque<Queued> queue;
  std::size_t queued_bytes = 0;
  ReceiverCounts counts;
  std::uint32_t refused_address = 0;
  std::uint32_t last_dropped = 0;

  std::thread thread;  // ends first
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
  if (!impl_->socket) {
    impl_->start();
  }
}

int UdpmReceiver::handle(std::chrono::milliseconds timeout, int max) {
  pollfd entry{impl_->waiting.get(), POLLIN, 0};
  if (::poll(&entry, 1, static_cast<int>(timeout.count())) <= 0 && !impl_->catch_up()) {
    return 0;
  }
  int handled = 0;
  while (handled < max) {
    const std::optional<Impl::Queued> message = impl_->next();
    if (!message) {
      break;
    }
    ++handled;
    message->subscription->handler(
        {message->channel, {message->bytes.get(), message->size}, message->received});
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
