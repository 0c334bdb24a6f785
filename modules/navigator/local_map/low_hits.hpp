// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/navigator/local_map/floor_evidence.hpp"
#include "modules/navigator/local_map/line_floor.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/local_map/obstacle_memory.hpp"

namespace nodmap::navigator {

/// The beams of one scan that ended on the floor, or so little above it that this may be noise. The
/// whole line decides which of them are obstacles.
class LowHits {
 public:
  struct Hit {
    std::size_t beam = 0;
    Eigen::Vector3d p_odom;
    double height_m = 0.0;  ///< above the tracked ground
    double sinking = 0.0;   ///< height that the beam loses per metre
  };

  explicit LowHits(double floor_tolerance_m) : floor_tolerance_m_(floor_tolerance_m) {}

  void begin_scan(std::size_t num_beams);

  /// Adds a hit within the floor's tolerance.
  void add_floor(const Hit& hit);
  /// Adds a hit above the tolerance.
  void add_low(const Hit& hit) { low_.push_back(hit); }

  /// Enters floor and obstacles into the grid. `is_level`: whether the ground is level. If it is
  /// not, the line decides nothing, because a ramp rises out of it as well.
  void end_scan(bool is_level, LocalGrid& grid, FloorEvidence& floor,
                const ObstacleMemory& obstacles, std::uint16_t scan);

 private:
  [[nodiscard]] static bool is_above_noise(const Hit& hit);
  [[nodiscard]] bool is_above_line(const Hit& hit) const;

  double floor_tolerance_m_;
  bool is_level_ = true;
  LineFloor line_floor_;
  std::vector<Hit> low_;
  std::vector<Hit> floor_;
};

}  // namespace nodmap::navigator
