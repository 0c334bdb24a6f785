// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model.hpp"

namespace nodmap::slam6d {

void Model::add(const Surface& surface_base, const geometry::SE3& T_map_base) {
  // All are judged against the model as it was: the surface itself is thin already.
  std::vector<Eigen::Vector3d> fresh;
  for (std::size_t i = 0; i < surface_base.points.size(); ++i) {
    const Eigen::Vector3d p_map = T_map_base * surface_base.points[i];
    if (!p_map.allFinite() || index_.nearest(p_map, point_spacing_m_)) {
      continue;
    }
    fresh.push_back(p_map);
    normals_.emplace_back(T_map_base.linear() * surface_base.normals[i]);
  }
  index_.add(fresh);
}

std::optional<Model::Partner> Model::nearest(const Eigen::Vector3d& p_map,
                                             double max_distance_m) const {
  const auto found = index_.nearest(p_map, max_distance_m);
  if (!found) {
    return std::nullopt;
  }
  return Partner{index_.points()[found->index], normals_[found->index]};
}

}  // namespace nodmap::slam6d
