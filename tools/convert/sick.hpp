// SPDX-License-Identifier: BSD-3-Clause
// Properties of a SICK LMS that recordings do not contain.
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::convert {

/// Smaller readings are not distances: a SICK reports errors as small numbers.
inline constexpr double kSickRangeMinM = 0.05;

/// Readings from here on mean "no echo" in the measuring mode of KURT3D.
inline constexpr double kSickIndoorRangeMaxM = 32.76;

/// The largest reading of this mode, 0x7fff mm, rounded up: what is farther away was measured by
/// another scanner.
inline constexpr double kSickIndoorLargestM = 32.77;

/// At half-degree resolution a scan takes two mirror revolutions at 75 Hz.
inline constexpr time::Duration kSickFinePeriod = 26'640us;

/// Start of recordings without times: an arbitrary constant, 2009-01-01.
inline constexpr time::Timestamp kUntimedStart(1'230'768'000s);

}  // namespace nodmap::convert
