// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "common/scan/scan.hpp"

namespace nodmap::navigator {

/// The ranges at which beams without a measurement are assumed to end, by beam; empty for all other
/// beams, and where nothing can be assumed.
///
/// A reflector that is hit nearly at a right angle dazzles the laser: these beams have no range,
/// although something is there. Obliquely the same surface is measured. So beams without a
/// measurement are assumed to end on the surface beside them in the scan, on the nearer one of two.
/// A surface within 15 degrees of a right angle is nowhere more than 4 % nearer than at its border,
/// and not wider than 30 degrees: about wider gaps nothing is assumed.
[[nodiscard]] std::vector<std::optional<double>> dazzled_ranges(const scan::Scan& scan);

}  // namespace nodmap::navigator
