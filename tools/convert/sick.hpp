// SPDX-License-Identifier: BSD-3-Clause
// What recordings of a SICK LMS leave out.
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::convert {

/// Readings below are no distances: a SICK sends small numbers for errors.
inline constexpr double kSickRangeMinM = 0.05;

/// From here on nothing came back, in the measuring mode of KURT3D.
inline constexpr double kSickIndoorRangeMaxM = 32.76;

/// At half-degree resolution the mirror turns twice at 75 Hz for one scan.
inline constexpr time::Duration kSickFinePeriod = 26'640us;

/// Recordings without time begin on 2009-01-01: any constant does.
inline constexpr time::Timestamp kUntimedStart(1'230'768'000s);

}  // namespace nodmap::convert
