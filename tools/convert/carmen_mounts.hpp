// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "tools/convert/carmen.hpp"

namespace nodmap::convert {

/// Finds the mounts of the scanners of a CARMEN robot. Each scan line contains the poses of scanner
/// and robot; if they always differ by the same offset, that is the mount. Otherwise (some tools
/// wrote a corrected pose for the scanner) it is taken from PARAM robot_frontlaser_offset and
/// robot_rearlaser_offset.
class CarmenMounts {
 public:
  void add(const CarmenScan& scan);
  void add(const CarmenParameter& parameter);

  /// T_base_laser, rounded to 0.1 mm and 0.1 mrad, the resolution of a log's decimals.
  [[nodiscard]] geometry::SE2 mount(LaserSide side) const;

  /// Whether the mount was computed from the scan lines themselves.
  [[nodiscard]] bool is_from_scans(LaserSide side) const;

 private:
  struct Side {
    std::optional<geometry::SE2> first_offset;
    bool agree = true;
    double parameter_m = 0.0;  ///< ahead of the robot's centre
  };
  [[nodiscard]] const Side& of(LaserSide side) const {
    return sides_[static_cast<std::size_t>(side)];
  }

  std::array<Side, 2> sides_;
};

}  // namespace nodmap::convert
