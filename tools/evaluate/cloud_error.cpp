// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/cloud_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "common/statistics/quantile.hpp"
#include "tools/evaluate/world_surfaces.hpp"

namespace nodmap::evaluate {
namespace {

constexpr double kSampleSpacingM = 0.05;

// Points in cells of size kOutlierM: a point nearer than that is in the same or a neighbouring
// cell.
class Cells {
 public:
  void add(const Eigen::Vector3d& p) { cells_[cell_of(p)].push_back(p); }

  [[nodiscard]] bool has_near(const Eigen::Vector3d& p) const {
    const Cell middle = cell_of(p);
    for (int i = 0; i < 27; ++i) {
      const auto found =
          cells_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (found != cells_.end() && std::ranges::any_of(found->second, [&p](const auto& q) {
            return (p - q).squaredNorm() <= kOutlierM * kOutlierM;
          })) {
        return true;
      }
    }
    return false;
  }

 private:
  using Cell = std::array<int, 3>;
  static Cell cell_of(const Eigen::Vector3d& p) {
    const Eigen::Vector3i cell = (p / kOutlierM).array().floor().cast<int>();
    return {cell.x(), cell.y(), cell.z()};
  }

  std::map<Cell, std::vector<Eigen::Vector3d>> cells_;
};

}  // namespace

CloudErrors measure_cloud(const std::vector<Eigen::Vector3f>& cloud_map,
                          const geometry::SE3& T_world_map, const sim::World& world) {
  CloudErrors errors;
  errors.n = cloud_map.size();
  if (cloud_map.empty()) {
    return errors;
  }
  const WorldSurfaces surfaces(world);
  Cells cells;
  std::vector<double> distances;
  double sum_m2 = 0.0;
  for (const Eigen::Vector3f& p_map : cloud_map) {
    const Eigen::Vector3d p_world = T_world_map * p_map.cast<double>();
    cells.add(p_world);
    distances.push_back(surfaces.distance_m(p_world));
    sum_m2 += distances.back() * distances.back();
  }
  const auto n = static_cast<double>(errors.n);
  errors.rms_m = std::sqrt(sum_m2 / n);
  errors.outlier_share = static_cast<double>(std::ranges::count_if(
                             distances, [](double d) { return d > kOutlierM; })) /
                         n;
  errors.p95_m = statistics::quantile(std::move(distances), 0.95);
  std::int64_t num_samples = 0;
  std::int64_t num_seen = 0;
  surfaces.for_each_sample(kSampleSpacingM, [&](const Eigen::Vector3d& p_sample) {
    ++num_samples;
    num_seen += cells.has_near(p_sample) ? 1 : 0;
  });
  errors.completeness =
      num_samples == 0 ? 0.0 : static_cast<double>(num_seen) / static_cast<double>(num_samples);
  return errors;
}

RemovalErrors measure_removal(const CloudErrors& before, const CloudErrors& after) {
  const auto moved = [](const CloudErrors& e) {
    return e.outlier_share * static_cast<double>(e.n);
  };
  const auto part = [](double some, double all) { return all > 0.0 ? some / all : 1.0; };
  const auto stays = [&moved](const CloudErrors& e) { return static_cast<double>(e.n) - moved(e); };
  RemovalErrors errors{.static_kept = part(stays(after), stays(before)),
                       .dynamic_removed = part(moved(before) - moved(after), moved(before))};
  errors.associated = std::sqrt(errors.static_kept * errors.dynamic_removed);
  return errors;
}

}  // namespace nodmap::evaluate
