// SPDX-License-Identifier: BSD-3-Clause
// What recordings of a SICK LMS leave out.
#pragma once

#include <cstdint>

namespace nodmap::convert {

/// Readings below are no distances: a SICK sends small numbers for errors.
inline constexpr double kSickRangeMinM = 0.05;

/// From here on nothing came back, in the measuring mode of KURT3D.
inline constexpr double kSickIndoorRangeMaxM = 32.76;

/// At half-degree resolution the mirror turns twice at 75 Hz for one scan.
inline constexpr std::int64_t kSickFinePeriodUs = 26'640;

/// Recordings without time begin on 2009-01-01: any constant does.
inline constexpr std::int64_t kUntimedStartUs = 1'230'768'000'000'000;

}  // namespace nodmap::convert
