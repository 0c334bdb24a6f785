// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as UDP datagrams from four senders, each behind its length. Messages that come out have
// a channel name, memory stays bounded, and the decoders accept or refuse them.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "common/bus/codec.hpp"
#include "common/bus/message_assembler.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"
#include "procman_lcm/orders_t.hpp"

namespace {

using namespace nodmap;  // NOLINT(google-build-using-namespace): a program of one page

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// A message that can be decoded is encoded to the same size again.
template <class Message>
void decode(std::span<const std::byte> bytes) {
  Message message{};
  if (bus::decode_into(message, bytes)) {
    require(static_cast<std::size_t>(message.getEncodedSize()) == bytes.size());
  }
}

void check(const bus::MessageAssembler::Message& message) {
  require(message.channel.size() <= bus::MessageAssembler::kMaxChannelLength);
  unsigned int sum = 0;
  for (const std::byte b : message.data) {
    sum += static_cast<unsigned int>(b);  // reads each byte
  }
  require(sum <= 255U * message.data.size());
  decode<nodmap::scan_t>(message.data);
  decode<nodmap::status_t>(message.data);
  decode<nodmap::cloud_chunk_t>(message.data);
  decode<procman_lcm::orders_t>(message.data);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bus::MessageAssembler assembler([](std::string_view channel) { return channel != "UNWANTED"; });
  std::span<const std::byte> rest = std::as_bytes(std::span(data, size));
  while (rest.size() >= 2) {
    const auto head = std::to_integer<unsigned int>(rest[0]);
    const std::size_t length = (head & 3U) << 8U | std::to_integer<unsigned int>(rest[1]);
    const std::span<const std::byte> datagram = rest.subspan(2, std::min(length, rest.size() - 2));
    if (const auto message =
            assembler.take({1, static_cast<std::uint16_t>(head >> 6U)}, datagram)) {
      check(*message);
    }
    require(assembler.pending_bytes() <= bus::MessageAssembler::kMaxPendingBytes);
    rest = rest.subspan(2 + datagram.size());
  }
  return 0;
}
