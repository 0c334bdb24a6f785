// SPDX-License-Identifier: BSD-3-Clause
// The telegrams of a SICK LMS2xx as the sensor sees them: it takes requests and makes answers.
// (SICK, Telegrams for Configuring and Operating the LMS2xx, 2006, chapters 3 and 12.)
#pragma once

#include <optional>
#include <variant>

#include "sim/bytes.hpp"

namespace nodmap::sim {

/// SICK's own checksum, over everything before it.
[[nodiscard]] std::uint16_t lms_checksum(ByteView bytes);

/// A telegram from the sensor: `body` is the reply code and its data.
[[nodiscard]] Bytes lms_telegram(std::uint8_t address, ByteView body, std::uint8_t status);

/// A request whose checksum holds: command and parameters.
struct LmsRequest {
  std::uint8_t address = 0;
  Bytes body;
};

/// A request that came damaged; the sensor answers NAK.
struct LmsDamaged {};

/// Finds requests in what the host sends.
class LmsRequestReader {
 public:
  void feed(ByteView bytes, std::int64_t now_us);
  [[nodiscard]] std::optional<std::variant<LmsRequest, LmsDamaged>> next();
  void reset() { buffer_.clear(); }

 private:
  Bytes buffer_;
  std::int64_t last_us_ = 0;
};

}  // namespace nodmap::sim
