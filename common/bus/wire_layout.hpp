// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/endian/conversion.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace nodmap::bus {

/// The number at this place, in network byte order as on the wire and in event logs; `bytes` must
/// reach to its end.
template <class Number>
[[nodiscard]] Number read_big_endian(std::span<const std::byte> bytes, std::size_t at = 0) {
  Number value{};
  std::memcpy(&value, bytes.subspan(at, sizeof(value)).data(), sizeof(value));
  return boost::endian::big_to_native(value);
}

enum class WireForm : std::uint8_t { kPlain, kString, kStruct };

/// The wire layout of one member of a message.
struct WireField {
  WireForm form = WireForm::kPlain;
  std::uint32_t size_bytes = 0;            ///< size of one element, for kPlain
  std::uint32_t fixed_count = 1;           ///< product of the literal dimensions
  std::int32_t count_slots[2] = {-1, -1};  ///< slots of the variable dimensions; -1: none
  std::int32_t stores_count = -1;     ///< slot that stores this integer as a count; -1: not a count
  std::span<const WireField> nested;  ///< members, for kStruct
};

/// Specialised for every message type in the generated nodmap/wire_layouts.hpp.
template <class Message>
struct WireLayout;

/// One message type, as data.
struct MessageType {
  std::string_view name;  ///< as in the .lcm file: nodmap.scan_t
  std::int64_t fingerprint = 0;
  std::span<const WireField> fields;
  bool begins_with_utime = false;  ///< its first member is the time of measurement, us
};

/// Whether `bytes` (without the fingerprint) are exactly one message of this layout: no negative
/// count, no array or string beyond the end, no bytes left over.
[[nodiscard]] bool fits_layout(std::span<const WireField> fields, std::span<const std::byte> bytes);

}  // namespace nodmap::bus
