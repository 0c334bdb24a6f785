// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace {

using boost::endian::load_little_u16;

// Positions of the special codes, counted down from the largest value (telegram listing, 10.1).
constexpr std::uint16_t kDazzled = 1;
constexpr std::uint16_t kBeyondReach = 8;

constexpr double kReachM = 80.0;  // limit of the optics; the values could encode more

constexpr std::uint16_t kCountBits = 0x03FF;
constexpr std::uint16_t kPartialBit = 0x2000;
constexpr unsigned kQuarterShift = 11;
constexpr std::uint16_t kMillimetreBit = 0x4000;
constexpr std::size_t kCountBytes = 2;

// Converts range words to metres, and counts those that are not ranges.
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

// The mirror revolution with every `stride`-th range from `first` on, measured in the half
// revolution that ended at `half_end`. `from_right_deg`: the angle of the first beam, 0 to the
// right.
MirrorRevolution revolution_of(const SickScan& scan, std::size_t first, std::size_t stride,
                               double from_right_deg, time::FineSteadyTime half_end) {
  MirrorRevolution revolution;
  for (std::size_t i = first; i < scan.ranges_m.size(); i += stride) {
    revolution.ranges_m.push_back(scan.ranges_m[i]);
  }
  const time::FineSteadyTime begin = half_end - (180.0 - from_right_deg) * kMirrorDegree;
  const auto beams = static_cast<double>(revolution.ranges_m.size());
  revolution.first_beam = time::rounded(begin);
  revolution.last_beam = time::rounded(begin + (beams - 1.0) * kMirrorDegree);
  revolution.angle_first_rad = geometry::deg_to_rad(from_right_deg - 90.0);
  revolution.angle_step_rad = geometry::deg_to_rad(1.0);
  revolution.range_max_m = scan.range_max_m;
  return revolution;
}

}  // namespace

SickGeometry geometry_of(SickVariant variant) {
  switch (variant) {
    case SickVariant::k180x050:
      return {180, 50, 2};
    case SickVariant::k100x100:
      return {100, 100, 1};
    case SickVariant::k100x050:
      return {100, 50, 2};
    case SickVariant::k100x025:
      return {100, 25, 4};
    case SickVariant::k180x100:
      break;
  }
  return {180, 100, 1};
}

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
  if (telegram.reply != SickReply::kMeasuredValues || !top || data.size() < kCountBytes) {
    return std::nullopt;
  }
  const std::uint16_t header = load_little_u16(data.data());
  const std::size_t count = header & kCountBits;
  const std::size_t values_end = kCountBytes + 2 * count;
  if (data.size() != values_end && data.size() != values_end + 2) {
    return std::nullopt;
  }
  const double unit_m = (header & kMillimetreBit) != 0 ? 0.001 : 0.01;
  SickScan scan;
  scan.first_byte = telegram.first_byte;
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
    scan.ranges_m[i] = range(load_little_u16(&data[kCountBytes + 2 * i]));
  }
  return scan;
}

std::vector<MirrorRevolution> mirror_revolutions(const SickScan& scan, SickVariant variant,
                                                 time::SteadyTime sent_at) {
  const SickGeometry geometry = geometry_of(variant);
  std::vector<MirrorRevolution> revolutions;
  for (int k = 0; k < geometry.revolutions; ++k) {
    const double first_deg = 90.0 - 0.5 * geometry.field_deg + 0.01 * geometry.resolution_cdeg * k;
    const time::FineSteadyTime end = sent_at - (geometry.revolutions - 1 - k) * kMirrorPeriod;
    revolutions.push_back(revolution_of(scan, static_cast<std::size_t>(k),
                                        static_cast<std::size_t>(geometry.revolutions), first_deg,
                                        end));
  }
  return revolutions;
}

MirrorRevolution interlaced_revolution(const SickScan& scan, time::SteadyTime sent_at) {
  const double first_deg = 0.25 * scan.quarter.value_or(0);
  return revolution_of(scan, 0, 1, first_deg, sent_at);
}

}  // namespace nodmap::laser3d
