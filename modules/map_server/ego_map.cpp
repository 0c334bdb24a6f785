// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/ego_map.hpp"

namespace nodmap::map_server {
namespace {

EgoMap make_map(const MapServerParams& params, Relevance relevance, double ceiling_m) {
  // The limit rises by three sigma of the pitch, which one floor reading in 700 exceeds at any
  // distance; the floor tolerance comes on top of it.
  const HeightBand band{params.robot.corridor_bottom_m(),
                        std::tan(3.0 * params.noise.pitch_sigma_rad), ceiling_m};
  return {ExtendedScan(AngleBins(params.bins.aperture_rad, params.bins.resolution_rad), relevance),
          make_update_rule(params, band)};
}

}  // namespace

EgoMap make_obstacle_map(const MapServerParams& params) {
  return make_map(params, Relevance::kNearest, params.robot.corridor_top_m());
}

EgoMap make_structure_map(const MapServerParams& params) {
  return make_map(params, Relevance::kFarthest, std::numeric_limits<double>::infinity());
}

}  // namespace nodmap::map_server
