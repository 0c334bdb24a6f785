// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/sweep_scan.hpp"

namespace nodmap::slam2d {

BeamHits deskewed(const SweepScan& scan, scan::ScanProjector& projector) {
  BeamHits hits(scan.scan.ranges_m.size());
  // Within the 13 ms of a scan a straight line is as good as the arc.
  const geometry::SE2 motion = scan.T_level_first.inverse() * scan.T_level_last;
  for (const scan::ScanProjector::Point& hit : projector.hits(scan.scan)) {
    const double part = scan.scan.fraction(hit.beam);
    const geometry::SE2 T_level_beam =
        scan.T_level_first * geometry::SE2{part * motion.x, part * motion.y, part * motion.yaw};
    const Eigen::Vector2d p = T_level_beam * Eigen::Vector2d(hit.p_base.head<2>());
    hits[hit.beam] = Eigen::Vector3d(p.x(), p.y(), hit.p_base.z());
  }
  return hits;
}

}  // namespace nodmap::slam2d
