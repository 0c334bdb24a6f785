// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>

#include "tools/convert/carmen.hpp"

namespace nodmap::convert {

/// Finds where a CARMEN robot carries its scanners. Each scan line holds both the scanner's and the
/// robot's pose; where they always differ by the same offset, that is the mount. Where they do not
/// (some tools wrote a corrected pose into the scanner's), PARAM robot_frontlaser_offset and
/// robot_rearlaser_offset tell.
class CarmenMounts {
 public:
  void add(const CarmenScan& scan);
  void add(const CarmenParameter& parameter);

  /// T_base_laser, to 0.1 mm and 0.1 mrad: a log's decimals hold no more.
  [[nodiscard]] geometry::SE2 mount(LaserSide side) const;

  /// Whether that is from the scan lines themselves.
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
