// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/ground/facet_finder.hpp"
#include "modules/navigator/ground/tracked_ground.hpp"
#include "modules/navigator/local_map/fan.hpp"
#include "modules/navigator/local_map/floor_evidence.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/local_map/local_view.hpp"
#include "modules/navigator/local_map/low_hits.hpp"
#include "modules/navigator/local_map/obstacle_memory.hpp"
#include "modules/navigator/local_map/seen_floor.hpp"
#include "modules/navigator/local_map/set_down_place.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// The ground around the robot as the nodding laser has seen it: a robot-centred grid in odom whose
/// cells are floor, obstacle, hole or "not seen".
///
///   obstacle  a beam ended between the floor and the top of the virtual corridor
///   hole      a beam passed through the floor, or did not come back from where floor should be
///   floor     a beam ended on it, or it lies between beams that did
///
/// Floor is all ground that is tracked, including ramps (ground/tracked_ground.hpp). What could be
/// a ramp that is not known yet, down from the last floor seen or up far away, stays "not seen".
///
/// The obstacle map of the paper has one point for each degree. This map also keeps what is beside
/// and behind the robot, what the nearest things hide, what is lower than the floor tolerance of
/// that map, and where floor is missing. An obstacle is forgotten when beams have passed through
/// its place in more scans than hit it, or when odometry has drifted too far since; a hole when
/// floor is seen there.
class LocalMap {
 public:
  LocalMap(const robot::RobotParams& robot, const LocalMapParams& params);

  /// Adds a scan. `T_odom_base`: at its middle. `is_walker`: for each beam, whether it has hit
  /// somebody who walks and is therefore left out; may be empty.
  void add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                const std::vector<bool>& is_walker = {});

  [[nodiscard]] bool has_scan() const { return T_odom_base_.has_value(); }

  /// Removes the obstacles on known floor around a place that were a person who walks there, or did
  /// a moment ago. What has been there for longer stays, however thin it is: around a chair's leg,
  /// too, there is floor on all sides.
  void forget_walker(const Eigen::Vector2d& p_odom, double radius_m);

  /// Adds an obstacle at the body's front or rear, because the robot pushes against something that
  /// beams do not show. Beams that pass through do not remove it.
  void add_contact(const geometry::SE2& T_odom_base, bool at_front);

  /// Obstacles and edges of holes within `range_m` of base, in base.
  [[nodiscard]] Points points_base(const geometry::SE2& T_odom_base, double range_m) const;

  /// Doubtful ground within `range_m` of base, but not under the body, in base: floor was never
  /// seen there, or an obstacle there has been forgotten and no beam has passed through its place
  /// since. The ground on which the robot was set down counts as seen.
  [[nodiscard]] Points doubtful_points_base(const geometry::SE2& T_odom_base, double range_m) const;

  /// Ground ahead of the body, in base, at which the laser has never looked, near the place where
  /// the robot was set down (see SetDownPlace).
  [[nodiscard]] Points unseen_ahead_base(const geometry::SE2& T_odom_base) const;

  /// Places within `range_m` of base, in base, where beams have passed through the floor, down to
  /// what could be a ramp: there is one, or a hole, but no floor on which the robot may drive
  /// before it has looked from nearer.
  [[nodiscard]] Points possible_ramps_down_base(const geometry::SE2& T_odom_base,
                                                double range_m) const;

  /// The lowest and highest points, above the ground, of the obstacles within `radius_m` of a
  /// place; empty if there are none.
  struct Span {
    double low_m = 0.0;
    double high_m = 0.0;
  };
  [[nodiscard]] std::optional<Span> obstacle_span(const Eigen::Vector2d& p_odom,
                                                  double radius_m) const;

  /// Empty outside the grid.
  [[nodiscard]] const LocalCell* cell_at(const Eigen::Vector2d& p_odom) const {
    return grid_.find(p_odom);
  }
  /// Whether a cell is blocked by a hole, or by an obstacle that is not forgotten.
  [[nodiscard]] bool is_blocked(const LocalCell& cell) const;
  /// Whether the obstacle in a cell could, by its height and what rises behind it, be a ramp that
  /// leads up from the floor before it. It could only from afar.
  [[nodiscard]] bool could_be_ramp(const Eigen::Vector2d& p_odom) const;
  /// A view of all cells in a square, `half_size_m` to each side.
  [[nodiscard]] LocalView view_around(const Eigen::Vector2d& p_odom, double half_size_m) const;
  [[nodiscard]] const LocalGrid& grid() const { return grid_; }

  [[nodiscard]] const TrackedGround& ground() const { return ground_; }
  /// A view of the map, valid until it changes.
  [[nodiscard]] SeenFloor seen_floor() const { return {grid_, obstacles_, body_, blind_m_}; }
  /// Whether nothing but floor is known at a place and in the cells around it.
  [[nodiscard]] bool is_only_floor(const Eigen::Vector2d& p_odom) const;
  /// The same, without floor that is only assumed, around the place where the robot was set down.
  [[nodiscard]] bool is_only_seen_floor(const Eigen::Vector2d& p_odom) const;

 private:
  void move(const geometry::SE2& T_odom_base);
  void clear_under_body(const geometry::SE2& T_odom_base);
  void classify(const Beam& beam, std::size_t index, double range_max_m);
  void add_dazzled(const Beam& beam);
  void classify_below(const Beam& beam, double range_m, std::size_t facet, bool is_certain);
  [[nodiscard]] std::size_t facet_passed(const Beam& beam, double range_m, std::size_t facet) const;
  void pass(const Beam& beam, double until_m);
  [[nodiscard]] static double range_to(const Plane& plane, const Beam& beam);
  void look_again(const TrackedGround::Joined& joined);
  [[nodiscard]] double tolerance_m(double range_m) const;
  [[nodiscard]] bool is_floor_around(const Eigen::Vector2d& p_odom, bool may_be_assumed) const;
  /// Calls `visit(index)` for the cells within `radius_m` of a place.
  template <class Visit>
  void visit_disc(const Eigen::Vector2d& p_odom, double radius_m, const Visit& visit) const;
  /// Calls `visit(index, p_base)` for the cells within `range_m` of base; p_base() computes the
  /// cell's middle in base.
  template <class Visit>
  void visit_cells(const geometry::SE2& T_odom_base, double range_m, const Visit& visit) const;

  robot::Footprint body_;
  double top_m_;
  double blind_m_;
  SetDownPlace set_down_;
  LocalMapParams params_;
  LocalGrid grid_;
  std::optional<geometry::SE2> T_odom_base_;
  Eigen::Matrix2d R_base_odom_ = Eigen::Matrix2d::Identity();
  TrackedGround ground_;
  FacetFinder finder_;
  FloorEvidence floor_;
  ObstacleMemory obstacles_;
  LowHits low_hits_;
  Points uncertain_holes_;  // odom; of the present scan
  std::uint16_t scan_ = 0;
  Fan fan_;
};

}  // namespace nodmap::navigator
