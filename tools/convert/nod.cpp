// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/nod.hpp"

#include <limits>
#include <utility>

#include "tools/convert/fields.hpp"
#include "tools/convert/sick.hpp"

namespace nodmap::convert {
namespace {

using geometry::deg_to_rad;

// The tilting device: TILT_RADIUS of its program, and the height of its axle, determined from the
// floor in its recordings (1.00 m; its program says 1.11 m).
constexpr double kMirrorAboveAxleM = 0.08;
constexpr double kAxleHeightM = 1.0;

template <class Form>
NodLine checked(const Fields& fields, scan::Scan scan) {
  if (!fields.ok()) {
    return NodUnreadable{"a number is missing or damaged"};
  }
  if (!fields.at_end()) {
    return NodUnreadable{"more words than its count of readings implies"};
  }
  if (!scan::is_plausible(scan)) {
    return NodUnreadable{"invalid angles or range limits"};
  }
  return Form{std::move(scan)};
}

NodLine parse_nod(Fields fields) {
  scan::Scan scan;
  scan.stamp = fields.stamp();
  scan.pitch_first_rad = -deg_to_rad(fields.finite());
  scan.pitch_last_rad = scan.pitch_first_rad;
  const std::size_t num_beams = fields.count();
  scan.angle_first_rad = fields.finite();
  scan.angle_step_rad = fields.finite();
  scan.range_min_m = fields.finite();
  scan.range_max_m = fields.finite();
  scan.T_base_mount.translation().z() = kAxleHeightM;
  scan.mirror_offset_m.z() = kMirrorAboveAxleM;
  scan.ranges_m = fields.numbers(num_beams);
  return checked<NodScan>(fields, std::move(scan));
}

NodLine parse_slice(Fields fields) {
  scan::Scan scan;
  fields.count();  // number of the slice
  scan.pitch_first_rad = deg_to_rad(fields.finite());
  scan.pitch_last_rad = scan.pitch_first_rad;
  const std::size_t num_beams = fields.count();
  scan.angle_first_rad = deg_to_rad(fields.finite() - 90.0);
  scan.angle_step_rad = deg_to_rad(fields.finite());
  scan.range_min_m = kSickRangeMinM;
  scan.range_max_m = kSickIndoorRangeMaxM;
  scan.ranges_m = fields.numbers(num_beams);
  for (float& range : scan.ranges_m) {
    const double range_m = 0.01 * static_cast<double>(range);
    range = range_m >= kSickIndoorRangeMaxM ? std::numeric_limits<float>::infinity()
                                            : static_cast<float>(range_m);  // NaN stays NaN
  }
  return checked<NodSlice>(fields, std::move(scan));
}

}  // namespace

NodLine parse_nod_line(std::string_view line) {
  Fields fields(line);
  const std::string_view form = fields.word();
  if (form.empty() || form.starts_with('#')) {
    return NodOther{};
  }
  if (form == "NOD") {
    return parse_nod(fields);
  }
  if (form == "SLICE") {
    return parse_slice(fields);
  }
  return NodUnreadable{"neither NOD nor SLICE"};
}

}  // namespace nodmap::convert
