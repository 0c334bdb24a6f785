// SPDX-License-Identifier: BSD-3-Clause
// Values back to the lines of a CARMEN log: parse_carmen_line() reads the same values again (poses
// and speeds to six decimals).
#pragma once

#include <string>

#include "tools/convert/carmen.hpp"

namespace nodmap::convert {

/// An ODOM line, without its end. `start_us`: where the logger's own clock began.
[[nodiscard]] std::string write_carmen_line(const CarmenOdometry& odometry, std::int64_t start_us);

/// A FLASER or RLASER line where such a line can tell everything, else ROBOTLASER1.
[[nodiscard]] std::string write_carmen_line(const CarmenScan& scan, std::int64_t start_us);

}  // namespace nodmap::convert
