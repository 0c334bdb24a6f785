// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_scan.hpp"

#include <algorithm>
#include <limits>

namespace nodmap::laser3d {
namespace {

// How far below the top of the range the codes lie (telegram listing, 10.1).
constexpr std::uint16_t kDazzled = 1;
constexpr std::uint16_t kBeyondReach = 8;

constexpr double kReachM = 80.0;  // of the optics, whatever the number could say

constexpr std::uint16_t kCountBits = 0x03FF;
constexpr std::uint16_t kPartialBit = 0x2000;
constexpr unsigned kQuarterShift = 11;
constexpr std::uint16_t kMillimetreBit = 0x4000;
constexpr std::size_t kHeaderBytes = 2;

/// Range words to metres; counts in the scan what was none.
class RangeReader {
 public:
  RangeReader(SickMeasuringMode mode, std::uint16_t top, double unit_m, SickScan& scan)
      : mode_(mode), top_(top), unit_m_(unit_m), scan_(scan) {}

  [[nodiscard]] float operator()(std::uint16_t word) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const auto value = static_cast<std::uint16_t>(word & mode_.mask());
    const int below_top = top_ - value;
    const bool flagged = mode_.has_dazzle_flag() && (word & 0x8000U) != 0;
    if (below_top == kDazzled || flagged) {
      ++scan_.num_dazzled;
      return kNone;
    }
    if (below_top == kBeyondReach) {
      ++scan_.num_beyond_reach;
      return std::numeric_limits<float>::infinity();
    }
    if (below_top < kBeyondReach) {
      ++scan_.num_unmeasured;
      return kNone;
    }
    return static_cast<float>(value * unit_m_);
  }

 private:
  SickMeasuringMode mode_;
  std::uint16_t top_;
  double unit_m_;
  SickScan& scan_;
};

}  // namespace

std::optional<std::uint16_t> SickMeasuringMode::top() const {
  switch (value) {
    case 0x00:
    case 0x01:
    case 0x02:
      return 0x1FFF;
    case 0x03:
    case 0x04:
      return 0x3FFF;
    case 0x05:
    case 0x06:
    case 0x0F:
      return 0x7FFF;
    default:
      return std::nullopt;
  }
}

std::uint16_t SickMeasuringMode::mask() const {
  return value == kInterlacedMode.value ? 0xFFFF : top().value_or(0);
}

std::optional<SickScan> read_scan(const SickTelegram& telegram, SickMeasuringMode mode) {
  const std::optional<std::uint16_t> top = mode.top();
  const ByteView data = telegram.data;
  if (telegram.reply != SickReply::kMeasuredValues || !top || data.size() < kHeaderBytes) {
    return std::nullopt;
  }
  const std::uint16_t header = read_u16(data, 0);
  const std::size_t count = header & kCountBits;
  const std::size_t values_end = kHeaderBytes + 2 * count;
  if (data.size() != values_end && data.size() != values_end + 2) {
    return std::nullopt;
  }
  const double unit_m = (header & kMillimetreBit) != 0 ? 0.001 : 0.01;
  SickScan scan;
  scan.first_byte_us = telegram.first_byte_us;
  scan.status = telegram.status;
  scan.range_max_m = std::min(kReachM, (*top - kBeyondReach - 1) * unit_m);
  if ((header & kPartialBit) != 0 || (header >> kQuarterShift & 3U) != 0) {
    scan.quarter = static_cast<int>(header >> kQuarterShift & 3U);
  }
  if (data.size() > values_end) {
    scan.indices = SickIndices{data[values_end], data[values_end + 1]};
  }
  RangeReader range(mode, *top, unit_m, scan);
  scan.ranges_m.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    scan.ranges_m[i] = range(read_u16(data, kHeaderBytes + 2 * i));
  }
  return scan;
}

}  // namespace nodmap::laser3d
