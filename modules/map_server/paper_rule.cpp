// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/paper_rule.hpp"

namespace nodmap::map_server {

std::size_t PaperRule::remove_obsolete(ExtendedScan& map, const HeightGate& /*gate*/,
                                       const ScanView& view) {
  std::size_t removed = 0;
  for (EgoPoint& point : map.points()) {
    if (!point.valid) {
      continue;
    }
    point.aged_s += view.elapsed_s;
    if (point.aged_s > expiry_s_) {
      point = map.dummy();
      ++removed;
    }
  }
  return removed;
}

void PaperRule::replace(ExtendedScan& map, const HeightGate& gate, const ScanView& view) {
  for (const Hit& hit : view.hits) {
    if (gate.admits(hit.point.height_m, hit.point.distance_m) &&
        map.prefers(hit.point.distance_m, map[hit.bin].distance_m)) {
      map[hit.bin] = hit.point;
    }
  }
}

}  // namespace nodmap::map_server
