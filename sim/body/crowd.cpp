// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/crowd.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>

namespace nodmap::sim {
namespace {

constexpr double kUpdateS = 0.02;
// Helbing, Farkas and Vicsek: 2000 N on 80 kg, 0.08 m, 0.5 s; no walker is faster than 1.3 times
// the desired speed.
constexpr double kStrengthMps2 = 2000.0 / 80.0;
constexpr double kRangeM = 0.08;
constexpr double kRelaxationS = 0.5;
constexpr double kFastest = 1.3;
// Influence of what is behind, relative to what is ahead.
constexpr double kBehind = 0.5;
// Beyond this distance the force is less than a thousandth.
constexpr double kForceReachM = 1.0;
constexpr double kArrivedM = 0.3;
// People step over objects lower than this, and walk under objects that begin above kHeadM.
constexpr double kStepOverM = 0.3;
constexpr double kHeadM = 1.5;

bool is_wall(const Object& object) {
  const auto stands = [](double center_m, double height_m) {
    return center_m + 0.5 * height_m > kStepOverM && center_m - 0.5 * height_m < kHeadM;
  };
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    return stands(box->center.z(), box->size.z());
  }
  const auto* cylinder = std::get_if<Cylinder>(&object.shape);
  return cylinder != nullptr && stands(cylinder->center.z(), cylinder->height_m);
}

// The vector from the nearest point of a wall to `p`; zero inside the wall.
Eigen::Vector2d from_wall(const Object& wall, const Eigen::Vector2d& p) {
  if (const auto* box = std::get_if<Box>(&wall.shape)) {
    const geometry::SE2 T_world_box{box->center.x(), box->center.y(), box->yaw_rad};
    const Eigen::Vector2d local = T_world_box.inverse() * p;
    const Eigen::Vector2d half = 0.5 * box->size.head<2>();
    return T_world_box.rotation() * (local - local.cwiseMax(-half).cwiseMin(half));
  }
  const auto& cylinder = std::get<Cylinder>(wall.shape);
  const Eigen::Vector2d v = p - cylinder.center.head<2>();
  return v * std::max(0.0, 1.0 - cylinder.radius_m / std::max(v.norm(), 1e-9));
}

// The repulsive force. `away` points from the other's surface to the walker's centre.
Eigen::Vector2d force(const Eigen::Vector2d& away, double radius_m,
                      const Eigen::Vector2d& heading) {
  const double distance_m = away.norm();
  if (distance_m <= 0.0 || distance_m > radius_m + kForceReachM) {
    return Eigen::Vector2d::Zero();
  }
  const Eigen::Vector2d direction = away / distance_m;
  const double ahead = -heading.dot(direction);
  const double sight = kBehind + (1.0 - kBehind) * 0.5 * (1.0 + ahead);
  return sight * kStrengthMps2 * std::exp((radius_m - distance_m) / kRangeM) * direction;
}

}  // namespace

Crowd::Crowd(const World& world, const BodyParams& robot)
    : actors_(world.actors), robot_radius_m_(0.5 * std::hypot(robot.length_m, robot.width_m)) {
  for (const Actor& actor : actors_) {
    any_reacts_ = any_reacts_ || actor.reacts;
    const auto next =
        std::ranges::upper_bound(actor.path, actor.time_in_round(0.0), {}, &Waypoint::time_s);
    const auto last = static_cast<std::ptrdiff_t>(actor.path.size()) - 1;
    walkers_.push_back({actor.position(0.0), Eigen::Vector2d::Zero(),
                        static_cast<std::size_t>(std::min(next - actor.path.begin(), last))});
    gaits_.emplace_back(actor.position(0.0));
  }
  std::ranges::copy_if(world.objects, std::back_inserter(walls_), is_wall);
}

ActorState Crowd::state(std::size_t actor) const {
  const Actor& a = actors_[actor];
  return {a.reacts ? walkers_[actor].position : a.position(time_s_),
          a.radius_m,
          a.height_m,
          actor,
          a.reflectivity,
          a.has_legs ? std::optional(gaits_[actor].legs()) : std::nullopt};
}

void Crowd::copy_present(std::vector<ActorState>& states) const {
  states.clear();
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (is_present(i)) {
      states.push_back(state(i));
    }
  }
}

void Crowd::advance(double time_s, const geometry::SE2& T_world_robot) {
  const double dt_s = time_s - time_s_;
  time_s_ = time_s;
  if (any_reacts_) {
    walk(T_world_robot, dt_s);
  }
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (actors_[i].has_legs) {
      gaits_[i].move_to(actors_[i].reacts ? walkers_[i].position : actors_[i].position(time_s));
    }
  }
}

// Moves the actors that react.
void Crowd::walk(const geometry::SE2& T_world_robot, double dt_s) {
  const double since_s = time_s_ - updated_s_;
  const bool is_due = since_s >= kUpdateS;
  updated_s_ = is_due ? time_s_ : updated_s_;
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (!actors_[i].reacts) {
      continue;
    }
    if (!is_present(i) || time_s_ < actors_[i].path.front().time_s) {
      walkers_[i].velocity.setZero();
      continue;
    }
    if (is_due) {
      update_velocity(i, since_s, {T_world_robot.translation(), robot_radius_m_});
    }
    walkers_[i].position += dt_s * walkers_[i].velocity;
  }
}

void Crowd::update_velocity(std::size_t actor, double dt_s, const Disc& robot) {
  Walker& walker = walkers_[actor];
  const Eigen::Vector2d desired = desired_velocity(actor);
  walker.velocity += dt_s * ((desired - walker.velocity) / kRelaxationS + repulsion(actor, robot));
  const double fastest_mps = kFastest * desired.norm();
  const double speed_mps = walker.velocity.norm();
  if (speed_mps > fastest_mps) {
    walker.velocity *= fastest_mps / speed_mps;
  }
}

Eigen::Vector2d Crowd::desired_velocity(std::size_t actor) {
  const std::vector<Waypoint>& path = actors_[actor].path;
  Walker& walker = walkers_[actor];
  if ((path[walker.next].position - walker.position).norm() < kArrivedM) {
    // A round ends where it began, so its first and last waypoint are the same.
    const std::size_t again = actors_[actor].loop ? 1 : path.size() - 1;
    walker.next =
        walker.next + 1 < path.size() ? walker.next + 1 : std::min(again, path.size() - 1);
  }
  const std::size_t next = std::max<std::size_t>(walker.next, 1);
  const Eigen::Vector2d to_next = path[walker.next].position - walker.position;
  if (next >= path.size() || to_next.norm() < kArrivedM) {
    return Eigen::Vector2d::Zero();
  }
  const double speed_mps = (path[next].position - path[next - 1].position).norm() /
                           (path[next].time_s - path[next - 1].time_s);
  return speed_mps * to_next.normalized();
}

Eigen::Vector2d Crowd::repulsion(std::size_t actor, const Disc& robot) const {
  const Walker& walker = walkers_[actor];
  const double radius_m = actors_[actor].radius_m;
  const double speed_mps = walker.velocity.norm();
  const Eigen::Vector2d heading =
      speed_mps > 0.0 ? Eigen::Vector2d(walker.velocity / speed_mps) : Eigen::Vector2d::Zero();
  Eigen::Vector2d sum = force(walker.position - robot.center, radius_m + robot.radius_m, heading);
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (i != actor && is_present(i)) {
      const ActorState other = state(i);
      sum += force(walker.position - other.position, radius_m + other.radius_m, heading);
    }
  }
  for (const Object& wall : walls_) {
    sum += force(from_wall(wall, walker.position), radius_m, heading);
  }
  return sum;
}

}  // namespace nodmap::sim
