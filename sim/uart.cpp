// SPDX-License-Identifier: BSD-3-Clause
#include "sim/uart.hpp"

#include <cmath>

namespace nodmap::sim {
namespace {

constexpr std::int64_t kBitsPerByte = 10;  // start, eight, stop

/// The line as the sender drives it; times in bits of the sender.
class Line {
 public:
  explicit Line(ByteView bytes) : bytes_(bytes) {}

  [[nodiscard]] std::int64_t end() const {
    return kBitsPerByte * static_cast<std::int64_t>(bytes_.size());
  }

  [[nodiscard]] bool high(std::int64_t bit) const {
    if (bit < 0 || bit >= end()) {
      return true;  // idle
    }
    const std::uint8_t byte = bytes_[static_cast<std::size_t>(bit / kBitsPerByte)];
    const std::int64_t within = bit % kBitsPerByte;
    return within == kBitsPerByte - 1 || (within > 0 && (byte >> (within - 1) & 1) != 0);
  }

  /// The first falling edge at or after `time`; end() when there is none.
  [[nodiscard]] std::int64_t falling_edge(double time) const {
    auto bit = static_cast<std::int64_t>(std::ceil(time));
    while (bit < end() && (high(bit) || !high(bit - 1))) {
      ++bit;
    }
    return bit;
  }

 private:
  ByteView bytes_;
};

}  // namespace

Bytes heard_at(int heard_baud, ByteView bytes, int sent_baud) {
  if (heard_baud == sent_baud) {
    return {bytes.begin(), bytes.end()};
  }
  if (heard_baud <= 0 || sent_baud <= 0) {
    return {};
  }
  const Line line(bytes);
  const double step = static_cast<double>(sent_baud) / heard_baud;
  const auto sample = [&](std::int64_t edge, double bits) {
    return line.high(
        static_cast<std::int64_t>(std::floor(static_cast<double>(edge) + bits * step)));
  };
  Bytes heard;
  double time = 0.0;
  for (std::int64_t edge = line.falling_edge(time); edge < line.end();
       edge = line.falling_edge(time)) {
    unsigned byte = 0;
    for (unsigned bit = 0; bit < 8; ++bit) {
      byte |= sample(edge, 1.5 + bit) ? 1U << bit : 0U;
    }
    heard.push_back(sample(edge, 9.5) ? static_cast<std::uint8_t>(byte) : std::uint8_t{0});
    time = static_cast<double>(edge) + 9.5 * step;
  }
  return heard;
}

}  // namespace nodmap::sim
