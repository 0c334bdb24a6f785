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
#include "modules/navigator/local_map/rolling_grid.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// What is known of one cell of the ground.
struct LocalCell {
  std::uint8_t obstacle = 0;  ///< evidence of something the body would hit
  std::uint8_t hole = 0;      ///< evidence of a drop
  bool is_floor = false;      ///< was seen, itself or between two beams that hit the floor
  bool is_assumed = false;    ///< not seen, but floor: the robot was set down there
  std::int16_t low_cm = 0;    ///< lowest and highest point measured of the obstacle, in odom
  std::int16_t high_cm = 0;
  std::uint16_t scan = 0;        ///< the last one in which evidence changed
  std::uint16_t seen_at_dm = 0;  ///< travel at the last hit, see LocalMap::travel
};

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

  /// The robot pushes against something at its front, or its rear, that beams do not show: it is an
  /// obstacle there from now on, whatever passes through.
  void add_contact(const geometry::SE2& T_odom_base, bool at_front);

  /// Obstacles and edges of holes within `range_m` of base, in base.
  [[nodiscard]] Points points_base(const geometry::SE2& T_odom_base, double range_m) const;

  /// How far the body's front, `half_width_m` to both sides, can move along an arc (curvature in
  /// 1/m, positive left) until floor that was not seen is nearer than the laser can look down, and
  /// cannot be looked at any more; at most `max_m`. Not seen is what is longer than `max_gap_m`
  /// along the arc between places where floor was seen, whenever that was: a hole as long would
  /// have had a beam in it.
  [[nodiscard]] double seen_distance(const geometry::SE2& T_odom_base, double curvature,
                                     double half_width_m, double max_m, double max_gap_m) const;

  /// The same for the body's rear, backwards. What the robot was set down on does not count.
  [[nodiscard]] double seen_distance_backwards(const geometry::SE2& T_odom_base, double curvature,
                                               double half_width_m, double max_m) const;

  /// Places within `range_m` of base, but not under the body, that are not known to be free: floor
  /// was never seen there, or an obstacle was and is forgotten, but no beam has passed through it
  /// since. In base. What the robot was set down on counts as seen.
  [[nodiscard]] Points doubtful_points_base(const geometry::SE2& T_odom_base, double range_m) const;

  /// Whether floor was seen at a place and around it, whatever is there now: at the foot of
  /// something that has always been there half of the cells around were never floor.
  [[nodiscard]] bool was_floor(const Eigen::Vector2d& p_odom) const;

  /// Empty outside the grid.
  [[nodiscard]] const LocalCell* cell_at(const Eigen::Vector2d& p_odom) const;
  [[nodiscard]] static bool is_obstacle(const LocalCell& cell);
  [[nodiscard]] static bool is_hole(const LocalCell& cell);
  /// Beams have passed through what was measured there.
  [[nodiscard]] static bool is_cleared(const LocalCell& cell);
  /// By a hole, or an obstacle that is not forgotten.
  [[nodiscard]] bool is_blocked(const LocalCell& cell) const;
  /// By the same, or because it is the edge of a hole. False outside the grid.
  [[nodiscard]] bool is_blocked_at(const Eigen::Vector2d& p_odom) const;
  [[nodiscard]] const RollingGrid<LocalCell>& grid() const { return grid_; }

  [[nodiscard]] const TrackedGround& ground() const { return ground_; }
  /// Whether floor is all that was seen in a place and in the cells around it.
  [[nodiscard]] bool is_free_floor(const Eigen::Vector2d& p_odom) const;

  /// The odom frame began anew.
  void reset();

 private:
  /// One beam in odom: where it starts, its direction, and its reading.
  struct Beam {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;
    double range_m = 0.0;  ///< +infinity: nothing came back
    bool is_hit = false;
  };
  /// Where a beam of the last scan met the floor.
  struct FloorPoint {
    Eigen::Vector2d p_odom = Eigen::Vector2d::Zero();
    bool is_valid = false;
  };

  void prepare_fan(const scan::Scan& scan);
  void move(const geometry::SE2& T_odom_base);
  void keep_near(const Eigen::Vector2d& p_odom);
  void clear_under_body(const geometry::SE2& T_odom_base);
  void classify(const Beam& beam, std::size_t index);
  void classify_below(const Beam& beam, double range_m, std::size_t facet, bool is_certain);
  [[nodiscard]] bool may_be_ramp_up(const Eigen::Vector3d& p_odom, double height_m) const;
  [[nodiscard]] bool may_be_ramp_down(const Eigen::Vector3d& p_odom,
                                      const Eigen::Vector2d& crossing_odom) const;
  [[nodiscard]] Eigen::Vector2d last_floor_before(const Eigen::Vector2d& p_odom,
                                                  double farthest_m) const;
  [[nodiscard]] static double range_to(const Plane& plane, const Beam& beam);
  void look_again(const TrackedGround::Joined& joined);
  void add_obstacle(const Eigen::Vector3d& p_odom, double height_m);
  void add_hole(const Eigen::Vector2d& p_odom, bool is_certain);
  void add_floor(std::size_t index, const Eigen::Vector2d& p_odom, double ground_m);
  void fill_floor();
  void fill_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void fill_between(const FloorPoint (&corners)[4]);
  void pass(const Beam& beam, double until_m);
  [[nodiscard]] bool is_row_seen(const geometry::SE2& T_odom_row, double half_width_m,
                                 bool assumed_counts) const;
  [[nodiscard]] double tolerance_m(double range_m) const;
  [[nodiscard]] bool is_blocked_at(const Eigen::Vector2i& index) const;
  [[nodiscard]] bool is_floor_near(const Eigen::Vector2i& index) const;
  [[nodiscard]] bool is_forgotten(const LocalCell& cell) const;
  [[nodiscard]] double travel_since_hit_m(const LocalCell& cell) const;
  [[nodiscard]] LocalCell* find(const Eigen::Vector2d& p_odom);

  robot::Footprint body_;
  double top_m_;
  double blind_m_;
  LocalMapParams params_;
  RollingGrid<LocalCell> grid_;
  std::optional<geometry::SE2> T_odom_base_;
  Eigen::Matrix2d R_base_odom_ = Eigen::Matrix2d::Identity();
  TrackedGround ground_;
  FacetFinder finder_;
  double travel_m_ = 0.0;              // path, and rotation by what it costs of accuracy
  std::uint16_t kept_near_at_dm_ = 0;  // travel
  std::uint16_t scan_ = 0;
  std::vector<Eigen::Vector2d> fan_;  // cos and sin of each beam's angle
  double fan_first_rad_ = 0.0;
  double fan_step_rad_ = 0.0;
  std::vector<FloorPoint> floor_;         // of this scan, by beam
  std::vector<FloorPoint> floor_before_;  // of the last one
};

}  // namespace nodmap::navigator
