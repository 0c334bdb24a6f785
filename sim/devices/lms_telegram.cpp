// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/lms_telegram.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {
namespace {

constexpr std::uint8_t kStx = 0x02;
constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kChecksumBytes = 2;
constexpr std::size_t kLongestRequest = 64;  // the configuration has 35 bytes
// The sensor drops a request with a longer pause in it (3.2.2).
constexpr time::Duration kLongestPause = 6ms;

// Positions of the special codes, counted down from the largest value (telegram listing, 10.1).
constexpr int kDazzled = 1;
constexpr int kBeyondReach = 8;

// The largest number that fits into the bits of the mode.
int top_of(std::uint8_t mode) {
  if (mode <= 0x02) {
    return 0x1FFF;
  }
  return mode <= 0x04 ? 0x3FFF : 0x7FFF;
}

}  // namespace

std::uint16_t lms_checksum(ByteView bytes) {
  std::uint16_t sum = 0;
  std::uint8_t before = 0;
  for (const std::uint8_t byte : bytes) {
    const bool carry = (sum & 0x8000U) != 0;
    sum = static_cast<std::uint16_t>((sum & 0x7FFFU) << 1U);
    if (carry) {
      sum ^= 0x8005U;
    }
    sum = static_cast<std::uint16_t>(sum ^ (before << 8U | byte));
    before = byte;
  }
  return sum;
}

Bytes lms_telegram(std::uint8_t address, ByteView body, std::uint8_t status) {
  Bytes bytes = {kStx, static_cast<std::uint8_t>(0x80U | address)};
  append_little_endian(bytes, static_cast<std::uint32_t>(body.size() + 1), 2);
  append(bytes, body);
  bytes.push_back(status);
  append_little_endian(bytes, lms_checksum(bytes), 2);
  return bytes;
}

void LmsRequestReader::feed(ByteView bytes, time::SteadyTime now) {
  if (now - last_ > kLongestPause) {
    buffer_.clear();
  }
  last_ = now;
  append(buffer_, bytes);
}

std::optional<std::variant<LmsRequest, LmsDamaged>> LmsRequestReader::next() {
  while (true) {
    buffer_.erase(buffer_.begin(), std::ranges::find(buffer_, kStx));
    if (buffer_.size() < kHeaderBytes) {
      return std::nullopt;
    }
    const std::size_t length = little_endian(ByteView(buffer_).subspan(2, 2));
    if (length == 0 || length > kLongestRequest) {
      buffer_.erase(buffer_.begin());
      continue;
    }
    const std::size_t size = kHeaderBytes + length + kChecksumBytes;
    if (buffer_.size() < size) {
      return std::nullopt;
    }
    const ByteView frame = ByteView(buffer_).first(size);
    const std::uint32_t sum = little_endian(frame.last(kChecksumBytes));
    const bool whole = lms_checksum(frame.first(size - kChecksumBytes)) == sum;
    const ByteView body = frame.subspan(kHeaderBytes, length);
    LmsRequest request{frame[1], Bytes(body.begin(), body.end())};
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size));
    if (!whole) {
      return LmsDamaged{};
    }
    return request;
  }
}

bool is_lms_measuring_mode(std::uint8_t mode) {
  return mode <= 0x06 || mode == kLmsPartialMode;
}

std::uint16_t lms_word(const Echo& echo, const LmsFormat& format) {
  constexpr int kDazzleFlag = 0x8000;
  const int top = top_of(format.measuring_mode);
  switch (echo.kind) {
    case Echo::Kind::kDazzled:
      return static_cast<std::uint16_t>((top - kDazzled) |
                                        (format.measuring_mode == 0 ? kDazzleFlag : 0));
    case Echo::Kind::kNothing:
      return static_cast<std::uint16_t>(top - kBeyondReach);
    case Echo::Kind::kRange:
      break;
  }
  const double value = std::round(echo.range_m * (format.millimetres ? 1000.0 : 100.0));
  // From the code on everything means "out of range"; the optics reach 80 m even if the bits could
  // encode more.
  return static_cast<std::uint16_t>(
      std::clamp(value, 0.0, static_cast<double>(top - kBeyondReach)));
}

std::uint16_t lms_header(std::size_t count, bool millimetres) {
  return static_cast<std::uint16_t>(count | (millimetres ? 0x4000U : 0U));
}

std::uint16_t lms_header(std::size_t count, bool millimetres, const LmsPartial& partial) {
  const auto quarter = static_cast<unsigned>(partial.quarter);
  return static_cast<std::uint16_t>(lms_header(count, millimetres) | 0x2000U | quarter << 11U);
}

}  // namespace nodmap::sim
