// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/whole_steps.hpp"
#include "modules/navigator/local_map/dazzled_surface.hpp"
#include "modules/navigator/local_map/holes.hpp"
#include "modules/navigator/local_map/mixed_pixel.hpp"
#include "modules/navigator/local_map/possible_ramp.hpp"

namespace nodmap::navigator {

LocalMap::LocalMap(const robot::RobotParams& robot, const LocalMapParams& params)
    : body_(robot.body.footprint()),
      top_m_(robot.corridor_top_m()),
      // Where the lowest beam meets the floor, and one line farther.
      blind_m_(robot.mount.x_m + 1.1 * robot.mount.z_m / std::tan(-robot.head.pitch_min_rad) +
               0.05),
      set_down_(blind_m_),
      params_(params),
      grid_(params.cell_size_m, 9),
      ground_(params.ground),
      finder_(params),
      floor_(params),
      obstacles_(params.forget_after_m),
      low_hits_(params.floor_tolerance_m) {}

bool LocalMap::is_blocked(const LocalCell& cell) const {
  return obstacles_.is_remembered(cell) || cell.is_hole();
}

bool LocalMap::could_be_ramp(const Eigen::Vector2d& p_odom) const {
  const LocalCell* cell = grid_.find(p_odom);
  if (cell == nullptr || cell->is_hole() || cell->is_contact() || !T_odom_base_) {
    return false;
  }
  const PossibleRamp ramp(grid_, ground_, params_, T_odom_base_->translation());
  return ramp.could_be(p_odom, cell->high_cm,
                       tolerance_m((p_odom - T_odom_base_->translation()).norm()));
}

LocalView LocalMap::view_around(const Eigen::Vector2d& p_odom, double half_size_m) const {
  return {grid_, obstacles_, grid_.index_of(p_odom),
          geometry::whole_steps(half_size_m, grid_.cell_size_m())};
}

// The greatest measured height, above or below 0, of a point on the floor: by noise, uneven floor,
// and errors of pitch and tilt, which grow with the distance.
double LocalMap::tolerance_m(double range_m) const {
  const double tilt_rad =
      ground_.is_level() ? params_.tilt_tolerance_rad : params_.ground.tilt_tolerance_rad;
  return params_.floor_tolerance_m + tilt_rad * range_m;
}

void LocalMap::add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                        const std::vector<bool>& is_walker) {
  if (fan_.take(scan)) {
    floor_.forget_last_scan();
  }
  move(T_odom_base);
  ++scan_;
  obstacles_.begin_scan(scan.mid_stamp());
  const std::size_t n = scan.ranges_m.size();
  floor_.begin_scan(n);
  low_hits_.begin_scan(n);
  uncertain_holes_.clear();
  const geometry::SE3 T_odom_mount = ground_.T_odom_base() * scan.T_base_mount;
  const std::vector<std::optional<double>> dazzled_m = dazzled_ranges(scan);
  for (std::size_t i = 0; i < n; ++i) {
    if ((is_walker.size() == n && is_walker[i]) || is_mixed_pixel(scan, i)) {
      continue;
    }
    Beam beam = fan_.beam(scan, i, T_odom_mount);
    if (beam.is_hit || beam.range_m == std::numeric_limits<double>::infinity()) {
      classify(beam, i, scan.range_max_m);
    } else if (dazzled_m[i]) {
      beam.range_m = *dazzled_m[i];
      add_dazzled(beam);
    }
  }
  low_hits_.end_scan(ground_.is_level(), grid_, floor_, obstacles_, scan_);
  for (const Eigen::Vector2d& p_odom : uncertain_holes_) {
    add_hole(grid_, p_odom, false, scan_, obstacles_.travel_dm());
  }
  finder_.end_scan(ground_, T_odom_base);
  for (const TrackedGround::Joined& joined : ground_.take_joined()) {
    look_again(joined);
  }
  floor_.end_scan(grid_, scan_);
  clear_under_body(T_odom_base);
}

void LocalMap::move(const geometry::SE2& T_odom_base) {
  if (T_odom_base_) {
    obstacles_.move(*T_odom_base_, T_odom_base);
  }
  grid_.center_on(T_odom_base.translation());
  obstacles_.keep_near(grid_, T_odom_base.translation());
  R_base_odom_ = T_odom_base.rotation().transpose();
  ground_.move(T_odom_base);
  const bool is_first = !T_odom_base_;
  T_odom_base_ = T_odom_base;
  if (is_first) {
    set_down_.begin(grid_, T_odom_base.translation());
  }
}

// Under the body there is floor and nothing else.
void LocalMap::clear_under_body(const geometry::SE2& T_odom_base) {
  const double step_m = 0.9 * grid_.cell_size_m();
  const robot::Footprint inner = body_.grown(-grid_.cell_size_m(), -grid_.cell_size_m());
  for (double x = -inner.half_length_m; x <= inner.half_length_m; x += step_m) {
    for (double y = -inner.half_width_m; y <= inner.half_width_m; y += step_m) {
      LocalCell cell;
      cell.is_floor = true;
      *grid_.find(T_odom_base * Eigen::Vector2d(x, y)) = cell;
    }
  }
}

// Without an echo there is nothing up to `range_max_m`.
void LocalMap::classify(const Beam& beam, std::size_t index, double range_max_m) {
  if (!beam.is_hit) {
    // A beam that should have met the ground within floor_return_m counts as if it had ended 1 m
    // beyond.
    constexpr double kBeyondM = 1.0;
    const std::size_t facet = ground_.facet_under_base();
    const double to_floor_m = range_to(ground_.plane(facet), beam);
    if (to_floor_m < std::min(params_.floor_return_m, range_max_m)) {
      classify_below(beam, to_floor_m + kBeyondM, facet, true);
    } else {
      pass(beam, range_max_m);
    }
    return;
  }
  using Kind = TrackedGround::Place::Kind;
  const Eigen::Vector3d p_odom = beam.origin + beam.range_m * beam.direction;
  const double tolerance = tolerance_m(beam.range_m);
  const TrackedGround::Place place = ground_.look(p_odom, tolerance);
  finder_.add(p_odom, R_base_odom_ * (p_odom.head<2>() - T_odom_base_->translation()));
  if (place.kind == Kind::kBelow) {
    const bool is_certain = place.height_m < -tolerance - evidence::kCertainM;
    if (is_certain || place.height_m < -evidence::range_noise_m(-beam.direction.z())) {
      classify_below(beam, beam.range_m, place.facet, is_certain);
    }
    return;
  }
  pass(beam, beam.range_m);
  if (place.kind == Kind::kGround) {
    ground_.grow(p_odom.head<2>(), place.facet);
    low_hits_.add_floor({index, p_odom, place.height_m, -beam.direction.z()});
    return;
  }
  const PossibleRamp ramp(grid_, ground_, params_, T_odom_base_->translation());
  const double distance_m = (p_odom.head<2>() - T_odom_base_->translation()).norm();
  if (place.height_m <= top_m_ && !ramp.leads_up(p_odom, place.height_m, tolerance_m(distance_m))) {
    const bool is_certain = place.height_m > params_.floor_tolerance_m + 2.0 * evidence::kCertainM;
    if (is_certain) {
      obstacles_.add_hit(grid_, p_odom, true, scan_);
    } else {
      low_hits_.add_low({index, p_odom, place.height_m, -beam.direction.z()});
    }
  }
}

// Only where the surface would be something that the body hits: on the floor, or high above it,
// nothing is assumed.
void LocalMap::add_dazzled(const Beam& beam) {
  const Eigen::Vector3d p_odom = beam.origin + beam.range_m * beam.direction;
  const TrackedGround::Place place = ground_.look(p_odom, tolerance_m(beam.range_m));
  if (place.kind == TrackedGround::Place::Kind::kAbove && place.height_m <= top_m_) {
    obstacles_.add_hit(grid_, p_odom, true, scan_);
  }
}

// Range at which a beam passes down through a plane; +infinity if it does not.
double LocalMap::range_to(const Plane& plane, const Beam& beam) {
  const double above_m = beam.origin.z() - plane.at(beam.origin.head<2>());
  const double sinking = plane.slope.dot(beam.direction.head<2>()) - beam.direction.z();
  return above_m > 0.0 && sinking > 0.0 ? above_m / sinking
                                        : std::numeric_limits<double>::infinity();
}

// The facet through which a beam that ends at `range_m`, below `facet`, may have passed. Where the
// ground is known to be lower, it is that ground: the level ground does not go on over a ramp down.
std::size_t LocalMap::facet_passed(const Beam& beam, double range_m, std::size_t facet) const {
  double to_facet_m = range_to(ground_.plane(facet), beam);
  for (std::size_t i = 0; i < ground_.num_facets() && to_facet_m <= range_m; ++i) {
    const auto known =
        ground_.known_facet_at((beam.origin + to_facet_m * beam.direction).head<2>());
    const double farther_m = known ? range_to(ground_.plane(*known), beam) : to_facet_m;
    if (farther_m <= to_facet_m) {
      break;
    }
    facet = *known;
    to_facet_m = farther_m;
  }
  return facet;
}

// A beam is below a facet at `range_m`: it has seen a hole where it passed through the ground,
// unless a ramp may lead down there.
void LocalMap::classify_below(const Beam& beam, double range_m, std::size_t facet,
                              bool is_certain) {
  const Eigen::Vector3d p_odom = beam.origin + range_m * beam.direction;
  const double tolerance = tolerance_m(range_m);
  const std::size_t passed = facet_passed(beam, range_m, facet);
  const Plane& plane = ground_.plane(passed);
  const double height_m = p_odom.z() - plane.at(p_odom.head<2>());
  if (passed != facet && height_m >= -tolerance) {
    pass(beam, range_m);  // it ended on this facet, farther than that is known
    return;
  }
  const double to_floor_m = range_to(plane, beam);
  pass(beam, std::min(to_floor_m, range_m));
  if (to_floor_m > range_m) {
    return;
  }
  const Eigen::Vector2d crossing_odom = (beam.origin + to_floor_m * beam.direction).head<2>();
  const PossibleRamp ramp(grid_, ground_, params_, T_odom_base_->translation());
  if (ramp.leads_down(p_odom, crossing_odom, plane, tolerance)) {
    add_possible_ramp(grid_, crossing_odom);
  } else if (is_certain && height_m < -tolerance - evidence::kCertainM) {
    add_hole(grid_, crossing_odom, true, scan_, obstacles_.travel_dm());
  } else {
    uncertain_holes_.push_back(crossing_odom);
  }
}

void LocalMap::pass(const Beam& beam, double until_m) {
  const double highest_m =
      ground_.T_odom_base().translation().z() + top_m_ +
      (ground_.is_level() ? 0.0 : ObstacleMemory::kFarthestPassM * ground_.max_slope());
  ObstacleMemory::pass(grid_, beam, until_m, highest_m, scan_);
}

// A cell has joined a facet: it was seen as ground. An obstacle in it that is no higher than the
// facet was this ground, and so was what may have been a ramp, and a hole on a facet ahead, which
// was not known before. All of it is looked at again from nearer.
void LocalMap::look_again(const TrackedGround::Joined& joined) {
  const double half_m = 0.5 * (ground_.cell_size_m() - grid_.cell_size_m());
  for (double dx = -half_m; dx <= half_m + 1e-6; dx += grid_.cell_size_m()) {
    for (double dy = -half_m; dy <= half_m + 1e-6; dy += grid_.cell_size_m()) {
      const Eigen::Vector2d p_odom = joined.middle_odom + Eigen::Vector2d(dx, dy);
      LocalCell* cell = grid_.find(p_odom);
      if (cell == nullptr) {
        continue;
      }
      cell->may_be_ramp = false;
      if (joined.is_ahead) {
        cell->hole = 0;
      }
      const double range_m = (p_odom - T_odom_base_->translation()).norm();
      if (!cell->is_contact() &&
          cell->high_cm <= to_centimetres(ground_.height_m(p_odom) + tolerance_m(range_m))) {
        cell->obstacle = 0;
      }
    }
  }
}

void LocalMap::add_contact(const geometry::SE2& T_odom_base, bool at_front) {
  obstacles_.add_contact(grid_, T_odom_base, body_, at_front);
}

template <class Visit>
void LocalMap::visit_disc(const Eigen::Vector2d& p_odom, double radius_m,
                          const Visit& visit) const {
  const int reach = geometry::whole_steps(radius_m, grid_.cell_size_m());
  const Eigen::Vector2i middle = grid_.index_of(p_odom);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      if (dx * dx + dy * dy <= reach * reach && grid_.contains(index)) {
        visit(index);
      }
    }
  }
}

void LocalMap::forget_walker(const Eigen::Vector2d& p_odom, double radius_m) {
  const SeenFloor floor = seen_floor();
  visit_disc(p_odom, radius_m, [&](const Eigen::Vector2i& index) {
    LocalCell& cell = grid_.at(index);
    if (cell.is_obstacle() && obstacles_.may_be_walker(cell) &&
        floor.is_around(grid_.center_of(index))) {
      obstacles_.remove_walker(cell);
    }
  });
}

std::optional<LocalMap::Span> LocalMap::obstacle_span(const Eigen::Vector2d& p_odom,
                                                      double radius_m) const {
  int low_cm = std::numeric_limits<int>::max();
  int high_cm = std::numeric_limits<int>::lowest();
  visit_disc(p_odom, radius_m, [&](const Eigen::Vector2i& index) {
    if (grid_.at(index).is_obstacle()) {
      low_cm = std::min<int>(low_cm, grid_.at(index).low_cm);
      high_cm = std::max<int>(high_cm, grid_.at(index).high_cm);
    }
  });
  if (low_cm > high_cm) {
    return std::nullopt;
  }
  const double ground_m = ground_.height_m(p_odom);
  return Span{0.01 * low_cm - ground_m, 0.01 * high_cm - ground_m};
}

template <class Visit>
void LocalMap::visit_cells(const geometry::SE2& T_odom_base, double range_m,
                           const Visit& visit) const {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  const Eigen::Matrix2d R_base_odom = T_base_odom.rotation();
  visit_disc(T_odom_base.translation(), range_m, [&](const Eigen::Vector2i& index) {
    visit(index, [&] {
      return Eigen::Vector2d(R_base_odom * grid_.center_of(index) + T_base_odom.translation());
    });
  });
}

Points LocalMap::points_base(const geometry::SE2& T_odom_base, double range_m) const {
  Points points;
  const LocalView view = view_around(T_odom_base.translation(), range_m);
  visit_cells(T_odom_base, range_m, [&](const Eigen::Vector2i& index, const auto& p_base) {
    if ((view.at(index) & LocalView::kBlocked) != 0U) {
      points.push_back(p_base());
    }
  });
  return points;
}

Points LocalMap::doubtful_points_base(const geometry::SE2& T_odom_base, double range_m) const {
  Points points;
  const SeenFloor floor = seen_floor();
  visit_cells(T_odom_base, range_m, [&](const Eigen::Vector2i& index, const auto& p_base) {
    const LocalCell& cell = grid_.at(index);
    const bool is_known =
        floor.is_near(index) && !(cell.is_obstacle() && obstacles_.is_forgotten(cell));
    if (!is_known && !body_.contains(p_base())) {
      points.push_back(p_base());
    }
  });
  return points;
}

Points LocalMap::unseen_ahead_base(const geometry::SE2& T_odom_base) const {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  Points points;
  for (const auto& p_odom : set_down_.never_seen_around(grid_, T_odom_base.translation())) {
    const Eigen::Vector2d p_base = T_base_odom * p_odom;
    if (p_base.x() > body_.half_length_m) {
      points.push_back(p_base);
    }
  }
  return points;
}

Points LocalMap::possible_ramps_down_base(const geometry::SE2& T_odom_base, double range_m) const {
  Points points;
  visit_cells(T_odom_base, range_m, [&](const Eigen::Vector2i& index, const auto& p_base) {
    if (is_possible_ramp_down(grid_, index)) {
      points.push_back(p_base());
    }
  });
  return points;
}

bool LocalMap::is_only_floor(const Eigen::Vector2d& p_odom) const {
  return is_floor_around(p_odom, true);
}

bool LocalMap::is_only_seen_floor(const Eigen::Vector2d& p_odom) const {
  return is_floor_around(p_odom, false);
}

bool LocalMap::is_floor_around(const Eigen::Vector2d& p_odom, bool may_be_assumed) const {
  bool is_floor = false;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const LocalCell* cell = cell_at(p_odom + grid_.cell_size_m() * Eigen::Vector2d(dx, dy));
      if (cell == nullptr || is_blocked(*cell) || (cell->is_assumed && !may_be_assumed)) {
        return false;
      }
      is_floor = is_floor || cell->is_floor;
    }
  }
  return is_floor;
}

}  // namespace nodmap::navigator
