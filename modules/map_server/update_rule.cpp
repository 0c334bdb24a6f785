// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/update_rule.hpp"

#include "modules/map_server/visibility_rule.hpp"

namespace nodmap::map_server {

std::size_t PaperRule::remove_obsolete(ExtendedScan& map, const NewScan& scan) {
  std::size_t removed = 0;
  for (EgoPoint& point : map.points()) {
    if (!point.valid) {
      continue;
    }
    point.aged_s += scan.elapsed_s;
    if (point.aged_s > expiry_s_) {
      point = map.dummy();
      ++removed;
    }
  }
  return removed;
}

void PaperRule::replace(ExtendedScan& map, const NewScan& scan) {
  for (const Hit& hit : scan.hits) {
    if (band_.contains(hit.point.height_m, hit.point.distance_m) &&
        map.prefers(hit.point.distance_m, map[hit.bin].distance_m)) {
      map[hit.bin] = hit.point;
    }
  }
}

std::unique_ptr<UpdateRule> make_update_rule(const MapServerParams& params,
                                             const HeightBand& band) {
  if (params.update.rule == RemovalRule::kPaper) {
    return std::make_unique<PaperRule>(band, params.update.expiry_s);
  }
  return std::make_unique<VisibilityRule>(params.update, band, params.noise.range_sigma_m,
                                          params.robot.body.footprint());
}

}  // namespace nodmap::map_server
