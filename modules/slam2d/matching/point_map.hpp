// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"

namespace nodmap::slam2d {

/// A point of the map, with the line through its neighbourhood. It fills one line of the
/// processor's cache.
struct alignas(64) MapPoint {
  OrientedPoint point;
  /// On the line: the mean of the neighbourhood.
  Eigen::Vector2d line_point = Eigen::Vector2d::Zero();
  /// Unit normal of the line; `point.normal` until there are enough neighbours. Zero if that is not
  /// known either, or if the neighbourhood is not a line (a corner, foliage).
  Eigen::Vector2d line_normal = Eigen::Vector2d::Zero();

  [[nodiscard]] bool has_line() const { return !line_normal.isZero(0.0); }
};

constexpr double kMinNormalCosine = 0.5;  // of similar normals: 60 degrees

/// Whether the angle between two normals has a cosine above `min_cosine`. An unknown normal is
/// similar to all.
inline bool have_similar_normals(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                 double min_cosine = kMinNormalCosine) {
  return a.dot(b) > min_cosine || a.isZero(0.0) || b.isZero(0.0);
}

/// The result of a search for the nearest map point, kept for the next search nearby. It fills two
/// lines of the processor's cache, the second with `others`.
struct alignas(64) Neighbourhood {
  static constexpr std::size_t kMaxOthers = 8;

  const MapPoint* nearest = nullptr;  ///< with a similar normal; null if there is none in reach
  OrientedPoint center;
  /// Within this distance of `center` there is no map point but `nearest`. Points whose normals
  /// would not be similar even after a small rotation do not count. Negative: not searched yet.
  double free_m = -1.0;
  /// Within this distance there are no map points but `nearest` and those in `others`, with the
  /// same exception.
  double known_m = -1.0;
  std::size_t num_others = 0;
  std::array<const MapPoint*, kMaxOthers> others;  ///< the first `num_others` are set

  // Leaves `others` as it is: setting it to zero takes 2 % of the time of a match.
  Neighbourhood() {}  // NOLINT(modernize-use-equals-default,cppcoreguidelines-pro-type-member-init)

  /// The map point nearest to `point` within `max_distance_m`, or null, as far as this result tells
  /// it; empty if the map must be searched. Moves the result to `point` if another map point may
  /// be the nearest by now, so that the next recall nearby need not compare them all.
  [[nodiscard]] std::optional<const MapPoint*> recall(const OrientedPoint& point,
                                                      double max_distance_m);
};

/// The incrementally built 2D map M of section IV A, in the map frame.
///
/// Each point also has the line through everything that was measured around it with a similar
/// normal. The line averages the noise of single measurements and fills the gaps between them. It
/// is updated when points are added, so that reading it costs nothing.
class PointMap {
  struct CellIndex {
    std::int32_t x = 0;
    std::int32_t y = 0;
    bool operator==(const CellIndex&) const = default;
  };

 public:
  /// The map points of a block of cells, side by side in memory. Points that follow each other in a
  /// scan are mostly searched for in the same block. Valid for one map, while it does not change.
  class Block {
    friend class PointMap;
    struct Entry {
      Eigen::Vector2d place;
      const MapPoint* point = nullptr;
    };
    struct InReach {
      const MapPoint* point = nullptr;
      double squared_m2 = 0.0;
    };
    CellIndex low_{1, 1};  // the corners; at first there is no cell in between
    CellIndex high_{0, 0};
    std::vector<Entry> entries_;
    std::vector<InReach> in_reach_;  // of the last search; as long as entries_
  };

  explicit PointMap(const MapParams& params) : params_(params) {}

  /// Takes measured points, one after the other, by the rule of section IV A: adds a point if no
  /// point of the map is within d_new, whatever its normal. Otherwise it only refines the lines
  /// around the point, which the paper neglects. Ignores points that are not finite.
  void insert(std::span<const OrientedPoint> points);

  /// Adds a point, and updates the lines around it. Ignores a point that is not finite.
  void add(const OrientedPoint& point);

  /// The nearest map point within `max_distance_m` whose normal differs by at most 60 degrees, so
  /// that the two sides of a thin wall stay apart; an unknown normal matches all. Null if there is
  /// none. Valid until the next `add` or `insert`.
  [[nodiscard]] const MapPoint* nearest(const OrientedPoint& point, double max_distance_m) const;

  /// The same, for repeated searches with a point that moves a little each time: searches the map
  /// only if the last result is not enough. `last`: the last result, which is updated; valid only
  /// while the map does not change. `block`: what the search before has read, for any point.
  [[nodiscard]] const MapPoint* nearest(const OrientedPoint& point, double max_distance_m,
                                        Neighbourhood& last, Block& block) const {
    if (const auto recalled = last.recall(point, max_distance_m)) {
      return *recalled;
    }
    look_around(point, max_distance_m, last, block);
    return last.nearest;
  }

  [[nodiscard]] std::span<const MapPoint> points() const { return points_; }

  /// Calls `visit` with the place and the index of each point within `radius_m` in x and y, and of
  /// some beyond.
  template <typename Visit>
  void for_each_around(const Eigen::Vector2d& p, double radius_m, Visit visit) const;

 private:
  /// A square of cells. Points lie in memory in the order in which a search reads them: cell after
  /// cell in a row, and row after row.
  static constexpr std::int32_t kTileCells = 8;
  struct Tile {
    /// Where the points of each cell begin, row by row; the last entry is where those of the last
    /// cell end.
    std::array<std::uint32_t, std::size_t{kTileCells} * kTileCells + 1> begins{};
    std::vector<Eigen::Vector2d> places;
    std::vector<std::uint32_t> indices;  ///< of the same points in points_
  };
  struct CellHash {
    std::size_t operator()(const CellIndex& index) const;
  };
  /// Sums over what was measured around a map point, relative to the point.
  struct Moments {
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    bool has_changed = false;  ///< since the line was fitted
    void add(const Eigen::Vector2d& d);
  };
  struct Search;

  [[nodiscard]] static CellIndex cell_index(const Eigen::Vector2d& p);
  [[nodiscard]] static CellIndex tile_index(CellIndex cell);
  [[nodiscard]] const Tile* find_tile(CellIndex tile) const;
  void enter(const Eigen::Vector2d& p, std::uint32_t index);
  /// Reads the cells within `radius_m` of `p`, unless the block holds just these.
  void read_block(const Eigen::Vector2d& p, double radius_m, Block& block) const;
  /// Returns the points of the block within reach, valid until the next call.
  [[nodiscard]] static std::span<const Block::InReach> find_in_reach(const Eigen::Vector2d& p,
                                                                     double reach_m2, Block& block);
  void look_around(const OrientedPoint& point, double max_distance_m, Neighbourhood& around,
                   Block& block) const;
  /// Finds the map points whose lines a point belongs to. Returns whether any map point is within
  /// d_new.
  bool find_neighbours(const OrientedPoint& point);
  /// Add a point, or only refine the lines around it; these stay as they were until
  /// fit_changed_lines(). To be called after find_neighbours().
  void add_point(const OrientedPoint& point);
  void refine_neighbours(const OrientedPoint& point);
  void measure(std::uint32_t index, const Eigen::Vector2d& d);
  void fit_changed_lines();
  void fit_line(std::uint32_t index);

  MapParams params_;
  std::vector<MapPoint> points_;
  std::vector<Moments> moments_;           // of each point
  std::vector<std::uint32_t> changed_;     // points whose moments have changed
  std::vector<std::uint32_t> neighbours_;  // of the last find_neighbours()
  std::vector<Tile> tiles_;
  // Number of each tile by its index. Never iterated, because its order is arbitrary.
  tsl::robin_map<CellIndex, std::uint32_t, CellHash> tile_numbers_;
};

template <typename Visit>
void PointMap::for_each_around(const Eigen::Vector2d& p, double radius_m, Visit visit) const {
  const CellIndex low = cell_index(p.array() - radius_m);
  const CellIndex high = cell_index(p.array() + radius_m);
  const CellIndex first = tile_index(low);
  const CellIndex last = tile_index(high);
  for (CellIndex index = first; index.y <= last.y; ++index.y) {
    const std::int32_t first_row = std::max(low.y - kTileCells * index.y, 0);
    const std::int32_t last_row = std::min(high.y - kTileCells * index.y, kTileCells - 1);
    for (index.x = first.x; index.x <= last.x; ++index.x) {
      const Tile* const tile = find_tile(index);
      if (tile == nullptr) {
        continue;
      }
      const std::int32_t first_column = std::max(low.x - kTileCells * index.x, 0);
      const std::int32_t last_column = std::min(high.x - kTileCells * index.x, kTileCells - 1);
      for (std::int32_t row = first_row; row <= last_row; ++row) {
        const std::uint32_t* const begins =
            &tile->begins[std::size_t{kTileCells} * static_cast<std::size_t>(row)];
        const std::uint32_t end = begins[last_column + 1];
        for (std::uint32_t i = begins[first_column]; i < end; ++i) {
          visit(tile->places[i], tile->indices[i]);
        }
      }
    }
  }
}

/// The nearest of some map points with a normal similar to that of `point`.
struct NearestOf {
  const OrientedPoint& point;
  double nearest_m2 = 0.0;  ///< of the nearest; at first of the reach
  const MapPoint* nearest = nullptr;
  double other_m2 = std::numeric_limits<double>::infinity();  ///< of the nearest of all others

  void consider(const MapPoint& map_point) {
    const double squared_m2 = (map_point.point.p - point.p).squaredNorm();
    if (squared_m2 <= nearest_m2 && have_similar_normals(point.normal, map_point.point.normal)) {
      other_m2 = nearest != nullptr ? std::min(other_m2, nearest_m2) : other_m2;
      nearest_m2 = squared_m2;
      nearest = &map_point;
    } else {
      other_m2 = std::min(other_m2, squared_m2);
    }
  }
  /// Whether no map point can be nearer, or within reach, if all within `known_m` were considered.
  [[nodiscard]] bool is_certain(double known_m) const {
    return known_m > 0.0 && nearest_m2 <= known_m * known_m;
  }
};

// Here, so that the compiler can merge it with the loop over all points of a scan.
inline std::optional<const MapPoint*> Neighbourhood::recall(const OrientedPoint& point,
                                                            double max_distance_m) {
  // A result holds for rotations of the point up to 0.1 rad.
  constexpr double kMinCosine = 0.9951;
  constexpr double kRoundingM = 1e-9;
  if (free_m < 0.0 || !have_similar_normals(point.normal, center.normal, kMinCosine)) {
    return std::nullopt;
  }
  const double moved_m = (point.p - center.p).norm() + kRoundingM;
  NearestOf search{.point = point, .nearest_m2 = max_distance_m * max_distance_m};
  if (nearest != nullptr) {
    search.consider(*nearest);
  }
  if (search.is_certain(free_m - moved_m)) {
    return search.nearest;
  }
  const std::span<const MapPoint*> known = std::span(others).first(num_others);
  for (const MapPoint* const other : known) {
    search.consider(*other);
  }
  if (!search.is_certain(known_m - moved_m)) {
    return std::nullopt;
  }
  if (nearest != nullptr && search.nearest != nullptr) {
    if (search.nearest != nearest) {
      *std::ranges::find(known, search.nearest) = std::exchange(nearest, search.nearest);
    }
    center.p = point.p;
    known_m -= moved_m;
    free_m = std::min(std::sqrt(search.other_m2), known_m);
  }
  return search.nearest;
}

}  // namespace nodmap::slam2d
