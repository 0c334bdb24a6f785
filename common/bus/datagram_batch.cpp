// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/datagram_batch.hpp"

#include <cstring>
#include <ctime>
#include <optional>

#include "common/geometry/clock.hpp"

namespace nodmap::bus {
namespace {

// The control message of this type that came with a datagram, if any.
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

}  // namespace

int DatagramBatch::receive(int socket) {
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

time::Timestamp DatagramBatch::received(std::size_t i) {
  const auto stamp = read_control<timeval>(headers_.at(i).msg_hdr, SCM_TIMESTAMP);
  return stamp ? time::Timestamp(stamp->tv_sec * 1s + stamp->tv_usec * 1us)
               : time::SystemClock().now();
}

std::uint32_t DatagramBatch::num_dropped(std::size_t i) {
  return read_control<std::uint32_t>(headers_.at(i).msg_hdr, SO_RXQ_OVFL).value_or(0);
}

}  // namespace nodmap::bus
