// SPDX-License-Identifier: BSD-3-Clause
// Binary frames of Foxglove's WebSocket protocol: numbers, service calls, and our only service.
#pragma once

#include <boost/endian/conversion.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "modules/viewer/foxglove/foxglove.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// Appends a number in the encoding of binary frames.
template <class Unsigned>
void append_little_endian(std::string& bytes, Unsigned value) {
  boost::endian::native_to_little_inplace(value);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// The number of the service `control`.
inline constexpr std::uint32_t kControlService = 1;

/// The description of the service `control`: JSON in, {"ok", "text"} out.
[[nodiscard]] Json control_service();

/// A call or its answer; their encodings differ only in the first byte.
struct ServiceCall {
  std::uint32_t service_id = 0;
  std::uint32_t call_id = 0;
  std::string_view encoding;
  std::string_view payload;
};

/// Reads a frame from a client; empty if it is not a call. The texts are parts of `bytes`.
[[nodiscard]] std::optional<ServiceCall> read_service_call(std::span<const std::byte> bytes);

/// The frame that answers a call with JSON.
[[nodiscard]] std::string service_answer(const ServiceCall& call, const Json& payload);

/// The text message for a call that cannot be answered.
[[nodiscard]] Json service_failure(const ServiceCall& call, const std::string& reason);

}  // namespace nodmap::viewer
