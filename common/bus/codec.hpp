// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/bus/wire_layout.hpp"
#include "nodmap/wire_layouts.hpp"

namespace nodmap::bus {

inline constexpr std::size_t kFingerprintBytes = 8;

/// The fingerprint at the start of an encoded message, or 0 if there is none.
[[nodiscard]] inline std::int64_t fingerprint_of(std::span<const std::byte> bytes) {
  return bytes.size() < kFingerprintBytes ? 0 : read_big_endian<std::int64_t>(bytes);
}

/// Decodes bytes that are exactly one valid message. Returns false and leaves `message` unchanged
/// for anything else: wrong fingerprint, too few or too many bytes, counts or strings that do not
/// fit. Never throws because of the data, and never allocates more than the given bytes can fill.
template <class Message>
[[nodiscard]] bool decode_into(Message& message, std::span<const std::byte> bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      fingerprint_of(bytes) != Message::getHash() ||
      !fits_layout(WireLayout<Message>::kFields, bytes.subspan(kFingerprintBytes))) {
    return false;
  }
  WireLayout<Message>::clear(message);
  const int size = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, size) == size;
}

/// Encodes into a buffer that keeps its capacity between calls. The counts in the message must
/// match its arrays, as lcm-gen requires.
template <class Message>
void encode_into(std::vector<std::byte>& buffer, const Message& message) {
  buffer.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
}

}  // namespace nodmap::bus
