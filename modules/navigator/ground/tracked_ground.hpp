// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/se3.hpp"
#include "modules/navigator/ground/plane.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/rolling_grid.hpp"

namespace nodmap::navigator {

/// The ground that is connected with the floor under the wheels: planes (facets) that meet in
/// kinks. Frame odom; z is measured from the floor on which the robot was set down, which counts as
/// level.
///
///                     ______  kink at the top: the lower of two facets is the ground
///                    /
///     _______ ______/         kink at the foot: the higher one
///
/// A grid of 20 cm cells says where each facet was seen. The body stands on the ground under its
/// four outermost wheels, so the ground gives the robot's height and tilt. On a facet the body is
/// parallel to it; over a kink it tilts gradually.
///
/// A facet flatter than 2 degrees counts as level, so that errors of the tilt end with each ramp.
class TrackedGround {
 public:
  explicit TrackedGround(const GroundParams& params);

  /// How a point lies relative to the ground.
  struct Place {
    enum class Kind : std::uint8_t { kGround, kAbove, kBelow };
    Kind kind = Kind::kGround;
    double height_m = 0.0;  ///< above the ground
    std::size_t facet = 0;  ///< the ground at this place
  };

  /// Takes the new pose. Height and tilt follow from the ground under the wheels.
  void move(const geometry::SE2& T_odom_base);
  [[nodiscard]] const geometry::SE3& T_odom_base() const { return T_odom_base_; }

  /// Whether all the ground within 1.6 m is one level plane.
  [[nodiscard]] bool is_level() const { return is_level_; }
  /// Classifies a point: nearer to the ground than `tolerance_m` it is ground.
  [[nodiscard]] Place look(const Eigen::Vector3d& p_odom, double tolerance_m) const;
  /// The height of the ground at a place. Where it is not known, the ground under the robot is
  /// extended.
  [[nodiscard]] double height_m(const Eigen::Vector2d& p_odom) const;
  [[nodiscard]] std::size_t facet_under_base() const { return under_base_; }
  [[nodiscard]] const Plane& plane(std::size_t facet) const { return facets_[facet].plane; }
  [[nodiscard]] bool is_known(const Eigen::Vector2d& p_odom) const { return mask_at(p_odom) != 0; }
  /// The facet that is the ground at a place; empty where the ground is not known.
  [[nodiscard]] std::optional<std::size_t> known_facet_at(const Eigen::Vector2d& p_odom) const;
  /// The steepest slope that the robot drives on, as a ratio.
  [[nodiscard]] double max_slope() const { return max_slope_; }

  /// Extends a facet to a place where it was seen, if it was also seen next to that place.
  void grow(const Eigen::Vector2d& p_odom, std::size_t facet);
  /// Makes a facet the ground at a place.
  void join(const Eigen::Vector2d& p_odom, std::size_t facet);
  /// Improves a facet by one more of its points. Has no effect once the robot is on it.
  void refine(std::size_t facet, const Eigen::Vector3d& p_odom);
  /// Adds a facet that rises (else falls) from the facet `before` it. Returns its index.
  std::size_t add_facet(const PlaneFit& fit, std::size_t before, bool rises);

  /// A cell that has joined a facet.
  struct Joined {
    Eigen::Vector2d middle_odom;
    bool is_ahead = false;  ///< the robot has not been on this facet yet
  };
  /// The cells that have joined since the last call. Empty while there is only the first facet.
  [[nodiscard]] std::vector<Joined> take_joined();
  [[nodiscard]] double cell_size_m() const { return cells_.cell_size_m(); }
  [[nodiscard]] std::size_t num_facets() const { return facets_.size(); }

 private:
  using Mask = std::uint16_t;
  static constexpr std::size_t kMaxFacets = 16;
  static constexpr std::size_t kNone = kMaxFacets;  ///< in no mask
  struct Facet {
    Plane plane;
    PlaneFit fit;
    std::size_t before = kNone;  ///< the facet at which it begins, until that is dropped
    bool rises = true;           ///< from that facet; else it falls
    bool is_fixed = false;  ///< not refined any more: the robot was on it, and it gives the tilt
  };
  struct Ground {
    double height_m = 0.0;
    std::size_t facet = 0;
  };

  [[nodiscard]] Mask mask_at(const Eigen::Vector2d& p_odom) const;
  [[nodiscard]] Ground ground_of(Mask mask, const Eigen::Vector2d& p_odom) const;
  [[nodiscard]] Ground under_wheel(const Eigen::Vector2d& p_odom, double last_m) const;
  [[nodiscard]] bool level_around(const Eigen::Vector2d& p_odom) const;
  [[nodiscard]] bool is_under_robot(std::size_t facet) const;
  std::size_t drop_facet_other_than(std::size_t kept);

  GroundParams params_;
  double max_slope_;
  std::vector<Facet> facets_;
  RollingGrid<Mask> cells_;
  std::array<Ground, 4> under_wheels_{};  // front left, front right, rear left, rear right
  std::size_t under_base_ = 0;
  geometry::SE3 T_odom_base_ = geometry::SE3::Identity();
  bool is_level_ = true;
  std::vector<Joined> joined_;
};

}  // namespace nodmap::navigator
