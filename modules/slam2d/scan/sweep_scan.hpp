// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::slam2d {

/// A scan of a sweep, and where base was at its first and last beam, in base at the first beam of
/// the level scan of that sweep.
struct SweepScan {
  const scan::Scan& scan;
  geometry::SE2 T_level_first = {};
  geometry::SE2 T_level_last = {};
};

/// The end points of a scan's beams, by beam, where there are any. In metres.
using BeamHits = std::vector<std::optional<Eigen::Vector3d>>;

/// The end points in base at the first beam of the level scan, as if the robot had stayed there.
/// The height is that above base as it was when the beam was measured.
[[nodiscard]] BeamHits deskewed(const SweepScan& scan, scan::ScanProjector& projector);

}  // namespace nodmap::slam2d
