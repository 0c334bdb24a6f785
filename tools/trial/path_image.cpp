// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/path_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace nodmap::trial {
namespace {

using drawing::Extent;
using drawing::PlanView;
using drawing::Rgb;
using Eigen::Vector2d;

constexpr double kLongerSidePx = 1400.0;
constexpr double kMaxPxPerM = 100.0;
constexpr double kBorderM = 0.3;
constexpr double kFastMps = 1.5;
// Objects that begin higher are not drawn: a ceiling would hide everything below.
constexpr double kCeilingM = 2.0;
constexpr Rgb kPit{200, 180, 230};
constexpr Rgb kRamp{220, 220, 190};
constexpr Rgb kActor{230, 120, 200};
constexpr Rgb kCollision{220, 0, 0};
constexpr Rgb kGoal{0, 150, 0};

std::array<Vector2d, 4> corners(const sim::Box& box) {
  const geometry::SE2 T_world_box{box.center.x(), box.center.y(), box.yaw_rad};
  const double x = 0.5 * box.size.x();
  const double y = 0.5 * box.size.y();
  return {T_world_box * Vector2d(x, y), T_world_box * Vector2d(-x, y),
          T_world_box * Vector2d(-x, -y), T_world_box * Vector2d(x, -y)};
}

std::array<Vector2d, 4> corners(const sim::Pit& pit) {
  return {pit.min, Vector2d(pit.max.x(), pit.min.y()), pit.max, Vector2d(pit.min.x(), pit.max.y())};
}

std::array<Vector2d, 4> corners(const sim::Ramp& ramp) {
  const Vector2d along = (ramp.to - ramp.from).head<2>().normalized();
  const Vector2d side = 0.5 * ramp.width_m * Vector2d(-along.y(), along.x());
  return {ramp.from.head<2>() + side, ramp.from.head<2>() - side, ramp.to.head<2>() - side,
          ramp.to.head<2>() + side};
}

Rgb shade(double bottom_m) {
  const double fraction = std::clamp(bottom_m / 0.5, 0.0, 1.0);
  const auto grey = static_cast<std::uint8_t>(190.0 - 110.0 * fraction);
  return {grey, grey, grey};
}

void draw(PlanView& view, const sim::Object& object) {
  if (const auto* box = std::get_if<sim::Box>(&object.shape)) {
    const double bottom_m = box->center.z() - 0.5 * box->size.z();
    if (bottom_m < kCeilingM) {
      view.fill_convex(corners(*box), shade(bottom_m));
    }
  } else if (const auto* cylinder = std::get_if<sim::Cylinder>(&object.shape)) {
    view.fill_disc(cylinder->center.head<2>(), cylinder->radius_m,
                   shade(cylinder->center.z() - 0.5 * cylinder->height_m));
  } else if (const auto* ramp = std::get_if<sim::Ramp>(&object.shape)) {
    view.fill_convex(corners(*ramp), kRamp);
  } else if (const auto* mesh = std::get_if<sim::Mesh>(&object.shape)) {
    for (const Eigen::Vector3i& triangle : mesh->triangles) {
      std::array<Vector2d, 3> points;
      for (int i = 0; i < 3; ++i) {
        points[static_cast<std::size_t>(i)] =
            mesh->vertices[static_cast<std::size_t>(triangle[i])].head<2>();
      }
      view.fill_convex(points, shade(0.2));
    }
  }
}

void draw(PlanView& view, const sim::World& world) {
  for (const sim::Pit& pit : world.pits) {
    view.fill_convex(corners(pit), kPit);
  }
  for (const sim::Object& object : world.objects) {
    draw(view, object);
  }
  for (const sim::Actor& actor : world.actors) {
    std::vector<Vector2d> path;
    for (const sim::Waypoint& waypoint : actor.path) {
      view.draw_circle(waypoint.position, actor.radius_m, kActor);
      path.push_back(waypoint.position);
    }
    view.draw_path(path, kActor, 1.0);
  }
  for (const Vector2d& goal : world.goals) {
    view.draw_circle(goal, 0.3, kGoal);
    view.draw_circle(goal, 0.1, kGoal);
  }
}

Vector2d position(const TruthSample& sample) {
  return sample.T_world_base.translation().head<2>();
}

void draw(PlanView& view, const TrialRecord& record) {
  for (std::size_t i = 1; i < record.truth.size(); ++i) {
    const TruthSample& to = record.truth[i];
    view.draw_line(position(record.truth[i - 1]), position(to),
                   drawing::colour_scale(std::abs(to.forward_mps) / kFastMps), 3.0);
  }
  for (std::size_t i = 1; i < record.truth.size(); ++i) {
    if (record.truth[i].contacts.collisions > record.truth[i - 1].contacts.collisions) {
      view.fill_disc(position(record.truth[i]), 0.08, kCollision);
      view.draw_circle(position(record.truth[i]), 0.28, kCollision);
    }
  }
}

Extent extent_of(const sim::World& world, const TrialRecord& record) {
  Extent extent;
  for (const sim::Object& object : world.objects) {
    if (const auto* box = std::get_if<sim::Box>(&object.shape)) {
      for (const Vector2d& corner : corners(*box)) {
        extent.add(corner);
      }
    } else if (const auto* cylinder = std::get_if<sim::Cylinder>(&object.shape)) {
      extent.add(cylinder->center.head<2>());
    }
  }
  for (const TruthSample& sample : record.truth) {
    extent.add(position(sample));
  }
  extent.grow(kBorderM);
  return extent;
}

}  // namespace

drawing::Image draw_paths(const sim::World& world, const TrialRecord& record,
                          const std::vector<EstimatedPath>& estimates) {
  const Extent extent = extent_of(world, record);
  PlanView view(extent, drawing::fitting_scale(extent, kLongerSidePx, kMaxPxPerM));
  draw(view, world);
  draw(view, record);
  const geometry::SE3 T_world_map = geometry::to_se3(world.T_world_start);
  std::vector<drawing::LegendEntry> legend{{"truth, slow", drawing::colour_scale(0.0)},
                                           {"truth, 1.5 m/s", drawing::colour_scale(1.0)}};
  for (const EstimatedPath& estimate : estimates) {
    std::vector<Vector2d> path;
    for (const formats::StampedPose& pose : estimate.poses) {
      path.emplace_back((T_world_map * pose.pose.translation()).head<2>());
    }
    view.draw_path(path, estimate.colour, 1.0);
    legend.push_back({estimate.name, estimate.colour});
  }
  if (!record.truth.empty()) {
    view.draw_start(position(record.truth.front()), kGoal);
    view.draw_end(position(record.truth.back()), kGoal);
  }
  view.draw_legend(legend);
  view.draw_scale_bar();
  return std::move(view).take();
}

}  // namespace nodmap::trial
