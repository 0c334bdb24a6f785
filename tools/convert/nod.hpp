// SPDX-License-Identifier: BSD-3-Clause
// Line-by-line recordings of a nodding scanner (.nod), in two forms.
//
//   NOD stamp_s tilt_deg n angle_min_rad angle_inc_rad range_min_m range_max_m r0..rn-1
//     a Hokuyo on a stepper; ranges in metres, inf or nan: no return. The tilt counts downwards,
//     and the mirror is above the axle, as in the program that recorded it (liangfok/
//     tilting_lidar_scanner); only then is its floor level.
//   SLICE k pitch_deg n first_deg step_deg r0..rn-1
//     one mirror revolution of the pitched SICK of KURT3D; the pitch counts upwards, beam angle 0
//     is right and 90 ahead, ranges in centimetres.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "common/scan/scan.hpp"

namespace nodmap::convert {

/// A NOD line; it has a stamp.
struct NodScan {
  scan::Scan scan;
};

/// A SLICE line; it has no stamp, so the reader assigns the time.
struct NodSlice {
  scan::Scan scan;
};

/// An empty line or a comment.
struct NodOther {};

struct NodUnreadable {
  std::string why;
};

using NodLine = std::variant<NodOther, NodScan, NodSlice, NodUnreadable>;

[[nodiscard]] NodLine parse_nod_line(std::string_view line);

}  // namespace nodmap::convert
