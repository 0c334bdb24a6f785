// SPDX-License-Identifier: BSD-3-Clause
// Conversion of values to the lines of a CARMEN log. parse_carmen_line() reads the same values
// again (poses and speeds to six decimals).
#pragma once

#include <string>

#include "common/geometry/time.hpp"
#include "tools/convert/carmen.hpp"

namespace nodmap::convert {

/// An ODOM line, without its end. `start`: the zero of the logger's own clock.
[[nodiscard]] std::string write_carmen_line(const CarmenOdometry& odometry, time::Timestamp start);

/// A FLASER or RLASER line if such a line can express everything, otherwise ROBOTLASER1.
[[nodiscard]] std::string write_carmen_line(const CarmenScan& scan, time::Timestamp start);

}  // namespace nodmap::convert
