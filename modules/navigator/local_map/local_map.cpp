// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nodmap::navigator {
namespace {

/// Evidence: a hit counts more than a beam that passes, for a thin leg fills its cell only in part,
/// and before the face of a sill, and close above it, beams meet the floor: a sweep of a fast robot
/// has one line on a low sill.
constexpr std::uint8_t kHit = 4;
constexpr std::uint8_t kMostEvidence = 12;
/// One hit suffices for what is clearly higher or lower than the floor; two for what may be noise.
constexpr std::uint8_t kEnough = 5;
constexpr std::uint8_t kCertain = 6;
/// Higher or lower than this by more than its tolerance no floor is measured, however the robot
/// tilts when it brakes: 0.6 degrees, 2 cm at 2 m.
constexpr double kCertainM = 0.03;
/// A rotation of 1 rad costs the heading as much as 4 m of driving: 2 degrees against 1 degree at
/// 1 m, both growing with the root.
constexpr double kMetresPerRad = 4.0;
/// So near to base an obstacle ages by one decimetre in so many of travel.
constexpr double kNearM = 0.5;
constexpr int kNearFactor = 5;
/// No beam is followed farther: what lies beyond is looked at again when it is near.
constexpr double kFarthestPassM = 3.5;
/// So near before the end of a beam nothing is passed: noise of the range, and the cell itself.
constexpr double kBeforeEndM = 0.03;
/// Across the body the floor is looked at in columns so far apart; so many of them make it unknown,
/// for one alone may lie between beams.
constexpr double kColumnM = 0.05;
constexpr int kUnknownColumns = 2;
/// Floor points no farther apart contradict a hole between them: one so narrow does not matter.
constexpr double kDenseM = 0.05;
/// So many cells around a hole belong to it: a beam that passes through the floor does so beyond
/// the edge, by up to the distance between two lines, and one that ends half on the edge has seen
/// floor where there is none.
constexpr int kEdgeCells = 2;

/// Pose of base after `distance_m` of an arc, negative backwards, in base at its beginning.
geometry::SE2 along_arc(double curvature, double distance_m) {
  const double yaw_rad = curvature * distance_m;
  return std::abs(curvature) < 1e-3 ? geometry::SE2{distance_m, 0.0, 0.0}
                                    : geometry::SE2{std::sin(yaw_rad) / curvature,
                                                    (1.0 - std::cos(yaw_rad)) / curvature, yaw_rad};
}

/// Whole centimetres, rounded down.
std::int16_t centimetres(double height_m) {
  return static_cast<std::int16_t>(std::floor(std::clamp(100.0 * height_m, -3e4, 3e4)));
}

/// Decimetres of travel; they begin anew after 6.5 km.
std::uint16_t to_dm(double travel_m) {
  return static_cast<std::uint16_t>(std::lround(10.0 * travel_m));
}

std::uint8_t more(std::uint8_t evidence, std::uint8_t by) {
  return std::min<std::uint8_t>(kMostEvidence, static_cast<std::uint8_t>(evidence + by));
}

std::uint8_t less(std::uint8_t evidence) {
  return evidence == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(evidence - 1);
}

}  // namespace

LocalMap::LocalMap(const robot::RobotParams& robot, const LocalMapParams& params)
    : body_(robot.body.footprint()),
      top_m_(robot.corridor_top_m()),
      // Where the beam of the lowest pitch meets the floor, and a line more.
      blind_m_(robot.mount.x_m + 1.1 * robot.mount.z_m / std::tan(-robot.head.pitch_min_rad) +
               0.05),
      params_(params),
      grid_(params.cell_size_m, 9),
      ground_(params.ground),
      finder_(params) {}

void LocalMap::reset() {
  T_odom_base_.reset();
  ground_.reset();
  finder_.reset();
  floor_before_.clear();
  grid_.center_on({1e6, 1e6});  // far away: every cell begins anew
}

bool LocalMap::is_obstacle(const LocalCell& cell) {
  return cell.obstacle >= kEnough;
}

bool LocalMap::is_hole(const LocalCell& cell) {
  return cell.hole >= kEnough;
}

bool LocalMap::is_cleared(const LocalCell& cell) {
  return cell.scan != 0 && !is_obstacle(cell) && !is_hole(cell);
}

bool LocalMap::is_blocked(const LocalCell& cell) const {
  return (is_obstacle(cell) && !is_forgotten(cell)) || is_hole(cell);
}

bool LocalMap::is_blocked_at(const Eigen::Vector2d& p_odom) const {
  return is_blocked_at(grid_.index_of(p_odom));
}

/// By what is in the cell, or by a hole whose edge it may be.
bool LocalMap::is_blocked_at(const Eigen::Vector2i& index) const {
  if (!grid_.contains(index)) {
    return false;
  }
  if (is_blocked(grid_.at(index))) {
    return true;
  }
  for (const Eigen::Vector2i& step :
       {Eigen::Vector2i(kEdgeCells, 0), Eigen::Vector2i(-kEdgeCells, 0),
        Eigen::Vector2i(0, kEdgeCells), Eigen::Vector2i(0, -kEdgeCells)}) {
    if (grid_.contains(index + step) && is_hole(grid_.at(index + step))) {
      return true;
    }
  }
  return false;
}

/// How far from 0 the height of a floor point may be measured: noise of range and pitch, uneven
/// floor and the body's tilt; the latter grow with the distance.
double LocalMap::tolerance_m(double range_m) const {
  const double tilt_rad =
      ground_.is_level() ? params_.tilt_tolerance_rad : params_.ground.tilt_tolerance_rad;
  return params_.floor_tolerance_m + tilt_rad * range_m;
}

bool LocalMap::is_forgotten(const LocalCell& cell) const {
  return travel_since_hit_m(cell) > params_.forget_after_m;
}

double LocalMap::travel_since_hit_m(const LocalCell& cell) const {
  return 0.1 * static_cast<std::uint16_t>(to_dm(travel_m_) - cell.seen_at_dm);
}

LocalCell* LocalMap::find(const Eigen::Vector2d& p_odom) {
  const Eigen::Vector2i index = grid_.index_of(p_odom);
  return grid_.contains(index) ? &grid_.at(index) : nullptr;
}

const LocalCell* LocalMap::cell_at(const Eigen::Vector2d& p_odom) const {
  const Eigen::Vector2i index = grid_.index_of(p_odom);
  return grid_.contains(index) ? &grid_.at(index) : nullptr;
}

void LocalMap::add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                        const std::vector<bool>& is_walker) {
  prepare_fan(scan);
  move(T_odom_base);
  ++scan_;
  const std::size_t n = scan.ranges_m.size();
  floor_.assign(n, {});
  const geometry::SE3 T_odom_mount = ground_.T_odom_base() * scan.T_base_mount;
  const Eigen::Matrix3d R = T_odom_mount.linear();
  for (std::size_t i = 0; i < n; ++i) {
    const double pitch_rad = scan.pitch_rad(i);
    const double c = std::cos(pitch_rad);
    const double s = std::sin(pitch_rad);
    const Eigen::Vector3d& offset = scan.mirror_offset_m;
    if (is_walker.size() == n && is_walker[i]) {
      continue;
    }
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    const Beam beam{T_odom_mount * Eigen::Vector3d(c * offset.x() - s * offset.z(), offset.y(),
                                                   s * offset.x() + c * offset.z()),
                    R * Eigen::Vector3d(c * fan_[i].x(), fan_[i].y(), s * fan_[i].x()), range_m,
                    scan.is_hit(i)};
    if (beam.is_hit || range_m == std::numeric_limits<double>::infinity()) {
      classify(beam, i);
    }
  }
  finder_.end_scan(ground_, T_odom_base);
  for (const TrackedGround::Joined& joined : ground_.take_joined()) {
    look_again(joined);
  }
  fill_floor();
  std::swap(floor_, floor_before_);
  clear_under_body(T_odom_base);
}

void LocalMap::prepare_fan(const scan::Scan& scan) {
  const std::size_t n = scan.ranges_m.size();
  if (fan_.size() == n && fan_first_rad_ == scan.angle_first_rad &&
      fan_step_rad_ == scan.angle_step_rad) {
    return;
  }
  fan_first_rad_ = scan.angle_first_rad;
  fan_step_rad_ = scan.angle_step_rad;
  fan_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    fan_[i] = {std::cos(scan.angle_rad(i)), std::sin(scan.angle_rad(i))};
  }
  floor_before_.clear();
}

void LocalMap::move(const geometry::SE2& T_odom_base) {
  if (T_odom_base_) {
    travel_m_ +=
        (T_odom_base.translation() - T_odom_base_->translation()).norm() +
        kMetresPerRad * std::abs(geometry::angle_difference(T_odom_base.yaw, T_odom_base_->yaw));
    // The stamps of cells are 16 bits of decimetres.
    travel_m_ = std::fmod(travel_m_, 6553.6);
  }
  grid_.center_on(T_odom_base.translation());
  keep_near(T_odom_base.translation());
  R_base_odom_ = T_odom_base.rotation().transpose();
  ground_.move(T_odom_base);
  const bool is_first = !T_odom_base_;
  T_odom_base_ = T_odom_base;
  if (is_first) {
    // The robot was set down on floor: as far as it cannot look, and cannot know better.
    for (double x = -blind_m_; x <= blind_m_; x += 0.5 * grid_.cell_size_m()) {
      for (double y = -blind_m_; y <= blind_m_; y += 0.5 * grid_.cell_size_m()) {
        LocalCell& cell = *find(T_odom_base * Eigen::Vector2d(x, y));
        cell.is_floor = cell.is_assumed = true;
      }
    }
  }
}

/// The laser does not look beside and behind the body, and the heading's error moves what is there
/// by next to nothing: it is remembered for longer, however the robot rotates on the spot. What is
/// forgotten stays so: its place is off by what odometry has drifted since.
void LocalMap::keep_near(const Eigen::Vector2d& p_odom) {
  const std::uint16_t travel_dm = to_dm(travel_m_);
  const int travelled_dm = static_cast<std::uint16_t>(travel_dm - kept_near_at_dm_);
  if (travelled_dm < kNearFactor) {
    return;
  }
  kept_near_at_dm_ = travel_dm;
  const int younger_dm = travelled_dm - travelled_dm / kNearFactor;
  const auto reach = static_cast<int>(kNearM / grid_.cell_size_m());
  const Eigen::Vector2i middle = grid_.index_of(p_odom);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      LocalCell& cell = grid_.at(middle + Eigen::Vector2i(dx, dy));
      if (dx * dx + dy * dy < reach * reach && is_obstacle(cell) && !is_forgotten(cell)) {
        const int age_dm = static_cast<std::uint16_t>(travel_dm - cell.seen_at_dm);
        cell.seen_at_dm =
            static_cast<std::uint16_t>(cell.seen_at_dm + std::min(younger_dm, age_dm));
      }
    }
  }
}

/// Where the body is there is floor, and nothing else.
void LocalMap::clear_under_body(const geometry::SE2& T_odom_base) {
  const double step_m = 0.9 * grid_.cell_size_m();
  const robot::Footprint inner = body_.grown(-grid_.cell_size_m(), -grid_.cell_size_m());
  for (double x = -inner.half_length_m; x <= inner.half_length_m; x += step_m) {
    for (double y = -inner.half_width_m; y <= inner.half_width_m; y += step_m) {
      LocalCell cell;
      cell.is_floor = true;
      *find(T_odom_base * Eigen::Vector2d(x, y)) = cell;
    }
  }
}

void LocalMap::classify(const Beam& beam, std::size_t index) {
  if (!beam.is_hit) {
    // It should have met the ground within floor_return_m: where it would be 1 m farther counts.
    constexpr double kBeyondM = 1.0;
    const std::size_t facet = ground_.facet_under_base();
    const double to_floor_m = range_to(ground_.plane(facet), beam);
    if (to_floor_m < params_.floor_return_m) {
      classify_below(beam, to_floor_m + kBeyondM, facet, true);
    } else {
      pass(beam, kFarthestPassM);
    }
    return;
  }
  using Kind = TrackedGround::Place::Kind;
  const Eigen::Vector3d p_odom = beam.origin + beam.range_m * beam.direction;
  const double tolerance = tolerance_m(beam.range_m);
  const TrackedGround::Place place = ground_.look(p_odom, tolerance);
  finder_.add(p_odom, R_base_odom_ * (p_odom.head<2>() - T_odom_base_->translation()));
  if (place.kind == Kind::kBelow) {
    classify_below(beam, beam.range_m, place.facet, place.height_m < -tolerance - kCertainM);
    return;
  }
  pass(beam, beam.range_m);
  if (place.kind == Kind::kGround) {
    ground_.grow(p_odom.head<2>(), place.facet);
    add_floor(index, p_odom.head<2>(), p_odom.z() - place.height_m);
  } else if (place.height_m <= top_m_ && !may_be_ramp_up(p_odom, place.height_m)) {
    add_obstacle(p_odom, place.height_m);
  }
}

/// Range at which a beam passes down through a plane; +infinity if it does not.
double LocalMap::range_to(const Plane& plane, const Beam& beam) {
  const double above_m = beam.origin.z() - plane.at(beam.origin.head<2>());
  const double sinking = plane.slope.dot(beam.direction.head<2>()) - beam.direction.z();
  return above_m > 0.0 && sinking > 0.0 ? above_m / sinking
                                        : std::numeric_limits<double>::infinity();
}

/// A beam that is below a facet at `range_m`: it saw a hole where it passed through, unless there
/// may be a ramp down.
void LocalMap::classify_below(const Beam& beam, double range_m, std::size_t facet,
                              bool is_certain) {
  const double to_floor_m = range_to(ground_.plane(facet), beam);
  pass(beam, std::min(to_floor_m, range_m));
  if (to_floor_m > range_m) {
    return;
  }
  const Eigen::Vector2d crossing_odom = (beam.origin + to_floor_m * beam.direction).head<2>();
  if (!may_be_ramp_down(beam.origin + range_m * beam.direction, crossing_odom)) {
    add_hole(crossing_odom, is_certain);
  }
}

/// Whether a point far away, `height_m` above the known ground, could be on a ramp that begins
/// behind the last floor seen before it. From nearer a ramp is known as one, and everything else is
/// an obstacle. So it is at once on level floor, where the robot is fast: a low sill is in view of
/// the narrow nod for a short time only.
bool LocalMap::may_be_ramp_up(const Eigen::Vector3d& p_odom, double height_m) const {
  const Eigen::Vector2d p = p_odom.head<2>();
  const double distance_m = (p - T_odom_base_->translation()).norm();
  if (ground_.is_level() || distance_m < params_.ground.doubt_from_m || cell_at(p) == nullptr) {
    return false;
  }
  // A ramp that is as high has begun no later than there.
  const double ramp_m = height_m / ground_.max_slope() + grid_.cell_size_m();
  const Eigen::Vector2d floor_odom = last_floor_before(p, std::min(ramp_m, distance_m));
  // What counts as floor may be higher by the tolerance, and the point by as much again.
  return p_odom.z() < ground_.height_m(floor_odom) + 2.0 * tolerance_m(distance_m) +
                          ground_.max_slope() * (p - floor_odom).norm();
}

/// Whether ground could lead down to a point from the last floor that was seen before the place
/// where the beam passed below it. Such a place is unknown until the laser looks down there more
/// steeply than the steepest ramp; before what is unknown the robot stops (seen_distance).
bool LocalMap::may_be_ramp_down(const Eigen::Vector3d& p_odom,
                                const Eigen::Vector2d& crossing_odom) const {
  constexpr double kFarthestM = 0.6;  // two lines on the floor at 2 m
  const Eigen::Vector2d floor_odom = last_floor_before(crossing_odom, kFarthestM);
  return p_odom.z() > ground_.height_m(floor_odom) - params_.floor_tolerance_m -
                          ground_.max_slope() * (p_odom.head<2>() - floor_odom).norm();
}

/// The nearest floor that was seen before a place, towards the robot; `farthest_m` before it if
/// there is none.
Eigen::Vector2d LocalMap::last_floor_before(const Eigen::Vector2d& p_odom,
                                            double farthest_m) const {
  const Eigen::Vector2d back = T_odom_base_->translation() - p_odom;
  const Eigen::Vector2d step = grid_.cell_size_m() / std::max(1e-3, back.norm()) * back;
  Eigen::Vector2d floor_odom = p_odom;
  for (double s = 0.0; s < std::min(farthest_m, back.norm()); s += grid_.cell_size_m()) {
    const LocalCell* cell = cell_at(floor_odom);
    if (cell != nullptr && cell->is_floor) {
      break;
    }
    floor_odom += step;
  }
  return floor_odom;
}

/// A cell joins a facet: an obstacle there that is no higher than that was this ground. So was a
/// hole, if it is on a facet ahead, which was not known before; it is looked at again from nearer.
void LocalMap::look_again(const TrackedGround::Joined& joined) {
  const double half_m = 0.5 * (ground_.cell_size_m() - grid_.cell_size_m());
  for (double dx = -half_m; dx <= half_m + 1e-6; dx += grid_.cell_size_m()) {
    for (double dy = -half_m; dy <= half_m + 1e-6; dy += grid_.cell_size_m()) {
      const Eigen::Vector2d p_odom = joined.middle_odom + Eigen::Vector2d(dx, dy);
      LocalCell* cell = find(p_odom);
      if (cell == nullptr) {
        continue;
      }
      if (joined.is_ahead) {
        cell->hole = 0;
      }
      const double range_m = (p_odom - T_odom_base_->translation()).norm();
      if (cell->high_cm <= centimetres(ground_.height_m(p_odom) + tolerance_m(range_m))) {
        cell->obstacle = 0;
      }
    }
  }
}

void LocalMap::add_obstacle(const Eigen::Vector3d& p_odom, double height_m) {
  LocalCell* cell = find(p_odom.head<2>());
  if (cell == nullptr) {
    return;
  }
  if (cell->obstacle == 0 || is_forgotten(*cell)) {
    cell->obstacle = 0;
    cell->low_cm = cell->high_cm = centimetres(p_odom.z());
  }
  const bool is_certain = height_m > params_.floor_tolerance_m + 2.0 * kCertainM;
  // The beams of one scan have their errors of pitch and tilt in common: they count once.
  if (is_certain || cell->scan != scan_) {
    cell->obstacle = more(cell->obstacle, is_certain ? kCertain : kHit);
  }
  cell->low_cm = std::min(cell->low_cm, centimetres(p_odom.z()));
  cell->high_cm = std::max(cell->high_cm, centimetres(p_odom.z()));
  cell->scan = scan_;
  cell->seen_at_dm = to_dm(travel_m_);
}

void LocalMap::add_contact(const geometry::SE2& T_odom_base, bool at_front) {
  const double x = (at_front ? 1.0 : -1.0) * (body_.half_length_m + grid_.cell_size_m());
  for (double y = -body_.half_width_m; y <= body_.half_width_m; y += 0.5 * grid_.cell_size_m()) {
    LocalCell* cell = find(T_odom_base * Eigen::Vector2d(x, y));
    if (cell != nullptr) {
      cell->obstacle = kMostEvidence;
      // No beam is between these heights.
      cell->low_cm = std::numeric_limits<std::int16_t>::max();
      cell->high_cm = std::numeric_limits<std::int16_t>::min();
      cell->seen_at_dm = to_dm(travel_m_);
    }
  }
}

void LocalMap::add_hole(const Eigen::Vector2d& p_odom, bool is_certain) {
  LocalCell* cell = find(p_odom);
  if (cell == nullptr) {
    return;
  }
  if (is_certain || cell->scan != scan_) {
    cell->hole = more(cell->hole, is_certain ? kCertain : kHit);
  }
  cell->is_floor = false;
  cell->scan = scan_;
  cell->seen_at_dm = to_dm(travel_m_);
}

void LocalMap::add_floor(std::size_t index, const Eigen::Vector2d& p_odom, double ground_m) {
  LocalCell* cell = find(p_odom);
  if (cell == nullptr) {
    return;
  }
  cell->is_floor = true;
  cell->is_assumed = false;
  if (cell->scan != scan_) {
    cell->hole = less(cell->hole);
    // Floor below a table top is no contradiction.
    if (0.01 * cell->low_cm - ground_m < params_.floor_tolerance_m + kCertainM) {
      cell->obstacle = less(cell->obstacle);
    }
    cell->scan = scan_;
  }
  floor_[index] = {p_odom, true};
}

/// Between two beams that are side by side, in this scan and the one before, and all hit the floor,
/// there is floor: what is high enough to matter would have been hit, and a hole wider than the
/// gap, too.
void LocalMap::fill_floor() {
  const bool has_before = floor_before_.size() == floor_.size();
  for (std::size_t i = 1; i < floor_.size(); ++i) {
    if (floor_[i - 1].is_valid && floor_[i].is_valid) {
      fill_line(floor_[i - 1].p_odom, floor_[i].p_odom);
    }
    if (!has_before) {
      continue;
    }
    const FloorPoint corners[4] = {floor_before_[i - 1], floor_before_[i], floor_[i - 1],
                                   floor_[i]};
    if (std::ranges::all_of(corners, &FloorPoint::is_valid)) {
      fill_between(corners);
    }
  }
}

/// Between two beams of one scan.
void LocalMap::fill_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length_m = (to - from).norm();
  if (length_m > params_.max_gap_m) {
    return;
  }
  const int steps = static_cast<int>(length_m / grid_.cell_size_m()) + 1;
  for (int step = 1; step < steps; ++step) {
    LocalCell* cell = find(from + (to - from) * step / steps);
    if (cell != nullptr && !is_hole(*cell)) {
      cell->is_floor = true;
      cell->is_assumed = false;
    }
  }
}

void LocalMap::fill_between(const FloorPoint (&corners)[4]) {
  const Eigen::Vector2d& a = corners[0].p_odom;
  const Eigen::Vector2d across = corners[1].p_odom - a;
  const Eigen::Vector2d along = corners[2].p_odom - a;
  const Eigen::Vector2d far_across = corners[3].p_odom - corners[2].p_odom;
  const double longest_m = std::max(along.norm(), (corners[3].p_odom - corners[1].p_odom).norm());
  const double widest_m = std::max(across.norm(), far_across.norm());
  if (longest_m > params_.max_gap_m || widest_m > params_.max_gap_m) {
    return;
  }
  const bool is_dense = longest_m <= kDenseM && widest_m <= kDenseM;
  const double step_m = 0.8 * grid_.cell_size_m();
  const int rows = static_cast<int>(longest_m / step_m) + 1;
  const int columns = static_cast<int>(widest_m / step_m) + 1;
  for (int row = 0; row <= rows; ++row) {
    const double u = static_cast<double>(row) / rows;
    for (int column = 0; column <= columns; ++column) {
      const double w = static_cast<double>(column) / columns;
      LocalCell* cell = find(a + u * along + w * ((1.0 - u) * across + u * far_across));
      if (cell == nullptr) {
        continue;
      }
      if (is_dense && cell->hole > 0 && cell->scan != scan_) {
        cell->hole = less(cell->hole);
        cell->scan = scan_;
      }
      if (!is_hole(*cell)) {
        cell->is_floor = true;
        cell->is_assumed = false;
      }
    }
  }
}

/// The cells that a beam passes over before `until_m`: an obstacle there would have ended it.
void LocalMap::pass(const Beam& beam, double until_m) {
  const double flat = beam.direction.head<2>().norm();
  if (flat < 1e-3) {
    return;
  }
  double end_m = std::min(until_m - kBeforeEndM, kFarthestPassM);
  if (beam.direction.z() > 0.0) {
    // Nothing that is remembered is higher.
    const double highest_m = ground_.T_odom_base().translation().z() + top_m_ +
                             (ground_.is_level() ? 0.0 : kFarthestPassM * ground_.max_slope());
    end_m = std::min(end_m, (highest_m - beam.origin.z()) / beam.direction.z());
  }
  // In cells from the grid's first one: never negative, so that a cast rounds down. This loop is
  // most of the time that a scan takes.
  const double step_m = grid_.cell_size_m() / flat;
  const double cells_per_m = 1.0 / grid_.cell_size_m();
  const Eigen::Vector2d step = step_m * cells_per_m * beam.direction.head<2>();
  Eigen::Vector2d place = cells_per_m * beam.origin.head<2>() - grid_.first().cast<double>();
  const double rise_cm = 100.0 * step_m * beam.direction.z();
  double height_cm = 100.0 * beam.origin.z();
  const auto steps = static_cast<int>(end_m / step_m);
  for (int i = 0; i < steps; ++i) {
    place += step;
    height_cm += rise_cm;
    LocalCell& cell = grid_.at_offset(static_cast<int>(place.x()), static_cast<int>(place.y()));
    // Heights are kept in whole centimetres, rounded down: a level laser hits and passes at one.
    if (cell.obstacle != 0 && cell.scan != scan_ && height_cm >= cell.low_cm &&
        height_cm < cell.high_cm + 1.0) {
      cell.obstacle = less(cell.obstacle);
      cell.scan = scan_;
    }
  }
}

Points LocalMap::points_base(const geometry::SE2& T_odom_base, double range_m) const {
  Points points;
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const Eigen::Matrix2d R_base_odom = T_base_odom.rotation();
  const auto reach = static_cast<int>(range_m / grid_.cell_size_m());
  const Eigen::Vector2i middle = grid_.index_of(T_odom_base.translation());
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      if (dx * dx + dy * dy > reach * reach || !grid_.contains(index)) {
        continue;
      }
      if (is_blocked_at(index)) {
        points.emplace_back(R_base_odom * grid_.center_of(index) + T_base_odom.translation());
      }
    }
  }
  return points;
}

/// Floor there, or so near that nothing fits in between.
bool LocalMap::is_floor_near(const Eigen::Vector2i& index) const {
  for (const Eigen::Vector2i& step :
       {Eigen::Vector2i(0, 0), Eigen::Vector2i(kEdgeCells, 0), Eigen::Vector2i(-kEdgeCells, 0),
        Eigen::Vector2i(0, kEdgeCells), Eigen::Vector2i(0, -kEdgeCells)}) {
    if (grid_.contains(index + step) && grid_.at(index + step).is_floor) {
      return true;
    }
  }
  return false;
}

Points LocalMap::doubtful_points_base(const geometry::SE2& T_odom_base, double range_m) const {
  Points points;
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const Eigen::Matrix2d R_base_odom = T_base_odom.rotation();
  const auto reach = static_cast<int>(range_m / grid_.cell_size_m());
  const Eigen::Vector2i middle = grid_.index_of(T_odom_base.translation());
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      if (dx * dx + dy * dy > reach * reach || !grid_.contains(index)) {
        continue;
      }
      const bool is_known =
          is_floor_near(index) && !(is_obstacle(grid_.at(index)) && is_forgotten(grid_.at(index)));
      const Eigen::Vector2d p_base =
          R_base_odom * grid_.center_of(index) + T_base_odom.translation();
      if (!is_known && !body_.contains(p_base)) {
        points.push_back(p_base);
      }
    }
  }
  return points;
}

bool LocalMap::is_free_floor(const Eigen::Vector2d& p_odom) const {
  bool is_floor = false;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const LocalCell* cell = cell_at(p_odom + grid_.cell_size_m() * Eigen::Vector2d(dx, dy));
      if (cell == nullptr || is_blocked(*cell)) {
        return false;
      }
      is_floor = is_floor || cell->is_floor;
    }
  }
  return is_floor;
}

bool LocalMap::was_floor(const Eigen::Vector2d& p_odom) const {
  constexpr int kEnoughOfNine = 8;
  int num_floor = 0;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const LocalCell* cell = cell_at(p_odom + grid_.cell_size_m() * Eigen::Vector2d(dx, dy));
      num_floor += cell != nullptr && cell->is_floor && !cell->is_assumed ? 1 : 0;
    }
  }
  return num_floor >= kEnoughOfNine;
}

double LocalMap::seen_distance(const geometry::SE2& T_odom_base, double curvature,
                               double half_width_m, double max_m, double max_gap_m) const {
  const double step_m = grid_.cell_size_m();
  const double first_m = std::max(0.0, blind_m_ - body_.half_length_m);
  // Where the middle of the front passes, and what is to the left there.
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> rows;
  for (double s = first_m; s < first_m + max_m + max_gap_m; s += step_m) {
    const geometry::SE2 T_odom_row = T_odom_base * along_arc(curvature, s);
    const Eigen::Matrix2d R = T_odom_row.rotation();
    rows.emplace_back(T_odom_row.translation() + body_.half_length_m * R.col(0), R.col(1));
  }
  const auto side = static_cast<int>(std::ceil(half_width_m / kColumnM));
  std::vector<double> seen_m;  // by column
  for (int column = -side; column <= side; ++column) {
    double seen = 0.0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double s = step_m * static_cast<double>(row);
      const LocalCell* cell =
          cell_at(rows[row].first + half_width_m * column / side * rows[row].second);
      if (cell != nullptr && cell->is_floor) {
        seen = s;
      } else if (s - seen > max_gap_m) {
        break;
      }
    }
    seen_m.push_back(seen);
  }
  std::ranges::nth_element(seen_m, seen_m.begin() + kUnknownColumns - 1);
  return std::min(seen_m[kUnknownColumns - 1], max_m);
}

double LocalMap::seen_distance_backwards(const geometry::SE2& T_odom_base, double curvature,
                                         double half_width_m, double max_m) const {
  const double step_m = grid_.cell_size_m();
  for (double s = step_m; s < max_m; s += step_m) {
    const geometry::SE2 T_base_rear{-body_.half_length_m, 0.0, 0.0};
    if (!is_row_seen(T_odom_base * along_arc(curvature, -s) * T_base_rear, half_width_m, false)) {
      return s - step_m;
    }
  }
  return max_m;
}

/// Whether floor was seen in a row across the body.
bool LocalMap::is_row_seen(const geometry::SE2& T_odom_row, double half_width_m,
                           bool assumed_counts) const {
  const auto columns = static_cast<int>(std::ceil(half_width_m / (2.0 * grid_.cell_size_m())));
  int unknown = 0;
  for (int column = -columns; column <= columns; ++column) {
    const LocalCell* cell =
        cell_at(T_odom_row * Eigen::Vector2d(0.0, half_width_m * column / columns));
    const bool is_seen = cell != nullptr && cell->is_floor && (assumed_counts || !cell->is_assumed);
    unknown += is_seen ? 0 : 1;
  }
  return unknown < kUnknownColumns;
}

}  // namespace nodmap::navigator
