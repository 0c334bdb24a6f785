// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/ground/facet_finder.hpp"
#include "modules/navigator/ground/tracked_ground.hpp"
#include "modules/navigator/local_map/floor_evidence.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/local_map/local_view.hpp"
#include "modules/navigator/local_map/low_hits.hpp"
#include "modules/navigator/local_map/obstacle_memory.hpp"
#include "modules/navigator/local_map/seen_floor.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// The ground around the robot as the nodding laser has seen it: a grid in odom, robot-centred,
/// that tells floor, obstacle, hole and "not seen" apart.
///
///   obstacle  a beam ended between the floor and the top of the virtual corridor
///   hole      a beam passed through the floor, or did not come back from where floor should be
///   floor     a beam ended on it, or it lies between beams that did
///
/// Floor is the ground that is tracked (ground/tracked_ground.hpp): ramps, too. What could be a
/// ramp that is not known yet, down from the last floor seen or far away up, stays "not seen".
///
/// The obstacle map of the paper has one point for each degree. This one keeps what is beside and
/// behind the robot, what is behind the nearest thing, what is lower than the floor tolerance of
/// that map, and what is missing. An obstacle is forgotten where beams pass through its place in
/// more scans than hit it, or where odometry has drifted too far since; a hole where floor is seen.
class LocalMap {
 public:
  LocalMap(const robot::RobotParams& robot, const LocalMapParams& params);

  /// `T_odom_base` at the middle of the scan. Beams for which `is_walker` is true, where there are
  /// as many of these as beams, have hit somebody who walks: he is no part of the ground.
  void add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                const std::vector<bool>& is_walker = {});

  [[nodiscard]] bool has_scan() const { return T_odom_base_.has_value(); }

  /// Somebody walks at a place, or did a moment ago: obstacles measured there, where floor is
  /// known, were that person.
  void forget_walker(const Eigen::Vector2d& p_odom, double radius_m);

  /// The robot pushes against something at its front or rear that beams do not show. It is an
  /// obstacle from now on, even if beams pass through.
  void add_contact(const geometry::SE2& T_odom_base, bool at_front);

  /// Obstacles and edges of holes within `range_m` of base, in base.
  [[nodiscard]] Points points_base(const geometry::SE2& T_odom_base, double range_m) const;

  /// How far the body's front, `half_width_m` to both sides, can move along an arc (curvature in
  /// 1/m, positive left) until floor that was not seen is nearer than the laser can look down, and
  /// cannot be looked at any more; at most `max_m`. Not seen is what is longer than `max_gap_m`
  /// along the arc between places where floor was seen, whenever that was: a hole as long would
  /// have had a beam in it. With `ends_at_obstacles` nothing is asked for behind an obstacle that
  /// is hardly farther than the laser sees floor: what that hides cannot be seen.
  [[nodiscard]] double seen_distance(const geometry::SE2& T_odom_base, double curvature,
                                     double half_width_m, double max_m, double max_gap_m,
                                     bool ends_at_obstacles = false) const;

  /// The same for the body's rear, driving backwards. Ground on which the robot was set down does
  /// not count as seen.
  [[nodiscard]] double seen_distance_backwards(const geometry::SE2& T_odom_base, double curvature,
                                               double half_width_m, double max_m) const;

  /// Places within `range_m` of base, but not under the body, that are not known to be free: floor
  /// was never seen there, or an obstacle was and is forgotten, but no beam has passed through it
  /// since. In base. What the robot was set down on counts as seen.
  [[nodiscard]] Points doubtful_points_base(const geometry::SE2& T_odom_base, double range_m) const;

  /// Whether floor was seen at a place and around it, whatever is there now: at the foot of
  /// something that has always been there half of the cells around were never floor.
  [[nodiscard]] bool was_floor(const Eigen::Vector2d& p_odom) const;

  /// Heights above the ground between which obstacles within `radius_m` of a place were measured;
  /// empty where there is none.
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
  /// Whether a place is blocked by the same, or is the edge of a hole. False outside the grid.
  [[nodiscard]] bool is_blocked_at(const Eigen::Vector2d& p_odom) const;
  /// A view of all cells in a square, `half_size_m` to each side.
  [[nodiscard]] LocalView view_around(const Eigen::Vector2d& p_odom, double half_size_m) const;
  [[nodiscard]] const LocalGrid& grid() const { return grid_; }

  [[nodiscard]] const TrackedGround& ground() const { return ground_; }
  /// Whether floor is all that was seen in a place and in the cells around it.
  [[nodiscard]] bool is_free_floor(const Eigen::Vector2d& p_odom) const;
  /// The same, for floor that the laser has seen; around the place where the robot was set down
  /// floor is only assumed.
  [[nodiscard]] bool is_seen_floor(const Eigen::Vector2d& p_odom) const;

  /// Forgets everything, because the odom frame restarted.
  void reset();

 private:
  void prepare_fan(const scan::Scan& scan);
  void move(const geometry::SE2& T_odom_base);
  void clear_under_body(const geometry::SE2& T_odom_base);
  void classify(const Beam& beam, std::size_t index);
  void classify_below(const Beam& beam, double range_m, std::size_t facet, bool is_certain);
  void pass(const Beam& beam, double until_m);
  [[nodiscard]] static double range_to(const Plane& plane, const Beam& beam);
  void look_again(const TrackedGround::Joined& joined);
  [[nodiscard]] double tolerance_m(double range_m) const;
  [[nodiscard]] bool is_floor_around(const Eigen::Vector2d& p_odom, bool may_be_assumed) const;
  /// `visit(index, p_base)` for the cells within `range_m` of base; p_base() is its middle there.
  template <class Visit>
  void visit_cells(const geometry::SE2& T_odom_base, double range_m, const Visit& visit) const;
  [[nodiscard]] SeenFloor seen_floor() const { return {grid_, obstacles_, body_, blind_m_}; }

  robot::Footprint body_;
  double top_m_;
  double blind_m_;
  LocalMapParams params_;
  LocalGrid grid_;
  std::optional<geometry::SE2> T_odom_base_;
  Eigen::Matrix2d R_base_odom_ = Eigen::Matrix2d::Identity();
  TrackedGround ground_;
  FacetFinder finder_;
  FloorEvidence floor_;
  ObstacleMemory obstacles_;
  LowHits low_hits_;
  std::uint16_t scan_ = 0;
  std::vector<Eigen::Vector2d> fan_;  // cos and sin of each beam's angle
  double fan_first_rad_ = 0.0;
  double fan_step_rad_ = 0.0;
};

}  // namespace nodmap::navigator
