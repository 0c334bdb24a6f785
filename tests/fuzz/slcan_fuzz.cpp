// SPDX-License-Identifier: BSD-3-Clause
// Any bytes on the line: the parser never fails and counts every line that it drops. A frame that
// it accepts is the same after writing and reading it again.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <variant>

#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/slcan.hpp"

namespace {

using nodmap::kurt::CanFrame;
using nodmap::kurt::SlcanLine;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void check_frame(const CanFrame& frame) {
  std::string line = nodmap::kurt::to_line(frame);
  line.pop_back();  // its CR
  const auto again = nodmap::kurt::parse_frame(line);
  CanFrame without_stamp = frame;
  without_stamp.stamp_ms.reset();
  require(again == without_stamp);
  const nodmap::kurt::Report report = nodmap::kurt::decode(frame);
  if (const auto* tilt = std::get_if<nodmap::kurt::Tilt>(&report)) {
    require(std::isfinite(tilt->roll_rad) && std::isfinite(tilt->pitch_rad));
  }
  if (const auto* ranges = std::get_if<nodmap::kurt::RangeReadings>(&report)) {
    for (const auto& raw : ranges->infrared_raw) {
      const auto range_m = nodmap::kurt::infrared_range_m(raw.value_or(-1));
      require(!range_m || (*range_m >= 0.0 && *range_m < 1.0));
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  nodmap::kurt::SlcanParser parser;
  std::int64_t ends = 0;
  std::int64_t answers = 0;
  bool begins = true;
  bool acknowledged = false;
  for (const std::uint8_t byte : std::span(data, size)) {
    const bool is_end = byte == '\r' || byte == '\a';
    // A z or Z where a line begins is an acknowledgement, with or without a CR.
    const bool acknowledges = begins && (byte == 'z' || byte == 'Z');
    ends += (is_end && !(acknowledged && byte == '\r')) || acknowledges ? 1 : 0;
    begins = is_end || acknowledges;
    acknowledged = acknowledges;
  }
  parser.push({data, size}, [&answers](const SlcanLine& line) {
    answers +=
        line.kind == SlcanLine::Kind::kFlags || line.kind == SlcanLine::Kind::kVersion ? 1 : 0;
    if (line.kind == SlcanLine::Kind::kFrame) {
      check_frame(line.frame);
    }
  });
  const nodmap::kurt::SlcanCounts& c = parser.counts();
  require(c.frames + c.done + c.refused + c.malformed + c.too_long + c.unknown + answers == ends);
  return 0;
}
