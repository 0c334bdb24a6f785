// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "modules/slam2d/surface_point.hpp"

namespace nodmap::slam2d {

/// The incrementally built 2D map M of section IV A: points that were new when they were seen.
///
/// Every point also knows the line through what was measured around it and looks the same way. It
/// is kept up to date while points come, so that asking costs nothing; it averages the noise of
/// single measurements away and fills the gaps between them.
class PointMap {
 public:
  /// A point of the map, with the line its neighbourhood forms.
  struct Landmark {
    SurfacePoint point;
    /// On the line: the mean of the neighbourhood.
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    /// Unit normal of the line: the scan's own where there are no neighbours yet; zero where that
    /// is not known either, or where the neighbourhood is no line but a corner or foliage.
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();

    [[nodiscard]] bool is_on_line() const { return !normal.isZero(0.0); }
  };

  /// `neighbour_radius_m`: how far the neighbourhood of a point reaches.
  explicit PointMap(double neighbour_radius_m);

  /// A point that is not finite is left out.
  void add(const SurfacePoint& point);

  /// Counts a point into the lines around it, but does not add it: a place that is on the map
  /// already, seen once more. A point that is not finite is left out.
  void refine(const SurfacePoint& point);

  /// The landmark nearest to a point, not farther than `max_distance_m`, that looks the same way
  /// (within 60 degrees, if both normals are known): the two sides of a thin wall are two surfaces.
  /// Valid until the next `add`.
  [[nodiscard]] const Landmark* nearest(const SurfacePoint& point, double max_distance_m) const;

  [[nodiscard]] std::span<const Landmark> landmarks() const { return landmarks_; }

 private:
  /// What a search looks at, side by side in memory.
  struct Entry {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();
    std::uint32_t landmark = 0;
  };
  using Cell = std::vector<Entry>;
  /// Sums over what was measured around a landmark, relative to the landmark.
  struct Moments {
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    void add(const Eigen::Vector2d& d);
  };
  struct CellIndex {
    std::int32_t x = 0;
    std::int32_t y = 0;
    bool operator==(const CellIndex&) const = default;
  };

  /// The nearest found so far in a search.
  struct Nearest {
    double squared_m2 = 0.0;
    const Entry* entry = nullptr;
  };

  void search_cell(CellIndex index, const SurfacePoint& point, Nearest& nearest) const;
  [[nodiscard]] static CellIndex index_of(const Eigen::Vector2d& p);
  /// Where the cell is in the table, or the free slot where it would go.
  [[nodiscard]] std::size_t slot_of(CellIndex index) const;
  [[nodiscard]] const Cell* find_cell(CellIndex index) const;
  Cell& make_cell(CellIndex index);
  void grow_table();
  /// Calls `visit` with the index of each landmark whose line the point belongs to.
  template <typename Visit>
  void for_each_neighbour(const SurfacePoint& point, Visit visit) const;
  void refit(std::uint32_t index);

  double neighbour_radius_m_;
  std::vector<Landmark> landmarks_;
  std::vector<Moments> moments_;
  std::vector<Cell> cells_;
  std::vector<CellIndex> cell_indices_;
  std::vector<std::int32_t> table_;  // open addressing into cells_, 2^k slots; -1 is free
};

}  // namespace nodmap::slam2d
