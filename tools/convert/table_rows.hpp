// SPDX-License-Identifier: BSD-3-Clause
// The fields of each type of message in a row of a table: the columns after the stamp, each
// preceded by a comma.
#pragma once

#include <ostream>

#include "nodmap/egomap_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/truth_t.hpp"

namespace nodmap::convert {

[[nodiscard]] const char* row_header(const nodmap::scan_t& message);
[[nodiscard]] const char* row_header(const nodmap::odometry_t& message);
[[nodiscard]] const char* row_header(const nodmap::pose_t& message);
[[nodiscard]] const char* row_header(const nodmap::truth_t& message);
[[nodiscard]] const char* row_header(const nodmap::egomap_t& message);
[[nodiscard]] const char* row_header(const nodmap::pitch_state_t& message);
[[nodiscard]] const char* row_header(const nodmap::pitch_command_t& message);
[[nodiscard]] const char* row_header(const nodmap::navigation_t& message);

/// Numbers are written with as many digits as are necessary to read the same number again, text in
/// quotes.
void put_row(std::ostream& out, const nodmap::scan_t& message);  ///< ends with all ranges
void put_row(std::ostream& out, const nodmap::odometry_t& message);
void put_row(std::ostream& out, const nodmap::pose_t& message);
void put_row(std::ostream& out, const nodmap::truth_t& message);  ///< ends with x, y of all actors
void put_row(std::ostream& out,
             const nodmap::egomap_t& message);  ///< ends with all points, in base
void put_row(std::ostream& out, const nodmap::pitch_state_t& message);
void put_row(std::ostream& out, const nodmap::pitch_command_t& message);
void put_row(std::ostream& out, const nodmap::navigation_t& message);

}  // namespace nodmap::convert
