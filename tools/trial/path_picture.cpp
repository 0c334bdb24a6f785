// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/path_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace nodmap::trial {
namespace {

using drawing::Image;
using drawing::Rgb;
using Eigen::Vector2d;

constexpr double kLongestPx = 1400.0;
constexpr double kBorderM = 0.3;
constexpr double kFastMps = 1.5;
/// Ceilings are left out: nothing would be seen below.
constexpr double kCeilingM = 2.0;
constexpr Rgb kPit{200, 180, 230};
constexpr Rgb kActor{230, 120, 200};
constexpr Rgb kRed{220, 0, 0};
constexpr Rgb kStart{0, 150, 0};

/// World to pixels.
struct Scale {
  Vector2d low;
  double px_per_m = 1.0;
  int height_px = 0;

  [[nodiscard]] Vector2d to_px(const Vector2d& p) const {
    return {px_per_m * (p.x() - low.x()), height_px - px_per_m * (p.y() - low.y())};
  }
};

struct Extent {
  Vector2d low = Vector2d::Constant(1e9);
  Vector2d high = Vector2d::Constant(-1e9);

  void add(const Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

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

class Painter {
 public:
  explicit Painter(const Extent& extent)
      : scale_(scale_of(extent)), image_(width_of(extent, scale_), scale_.height_px) {}

  void fill(std::span<const Vector2d> convex, Rgb colour) {
    Extent extent;
    for (const Vector2d& corner : convex) {
      extent.add(scale_.to_px(corner));
    }
    for (int y = static_cast<int>(extent.low.y()); y <= static_cast<int>(extent.high.y()); ++y) {
      for (int x = static_cast<int>(extent.low.x()); x <= static_cast<int>(extent.high.x()); ++x) {
        if (holds(convex, Vector2d(x + 0.5, y + 0.5))) {
          image_.set(x, y, colour);
        }
      }
    }
    for (std::size_t i = 0; i < convex.size(); ++i) {
      line(convex[i], convex[(i + 1) % convex.size()], colour,
           1.0);  // what is thinner than a pixel
    }
  }

  void line(const Vector2d& from, const Vector2d& to, Rgb colour, double width_px) {
    const Vector2d a = scale_.to_px(from);
    const Vector2d b = scale_.to_px(to);
    image_.draw_line(a.x(), a.y(), b.x(), b.y(), colour, width_px);
  }

  void disc(const Vector2d& center, double radius_m, Rgb colour) {
    const Vector2d p = scale_.to_px(center);
    image_.fill_disc(p.x(), p.y(), std::max(1.5, scale_.px_per_m * radius_m), colour);
  }

  void circle(const Vector2d& center, double radius_m, Rgb colour) {
    const Vector2d p = scale_.to_px(center);
    image_.draw_circle(p.x(), p.y(), scale_.px_per_m * radius_m, colour);
  }

  [[nodiscard]] Image take() { return std::move(image_); }

 private:
  static Scale scale_of(const Extent& extent) {
    const Vector2d size = extent.high - extent.low;
    const double px_per_m = std::min(100.0, kLongestPx / size.maxCoeff());
    return {extent.low, px_per_m, static_cast<int>(std::ceil(px_per_m * size.y()))};
  }
  static int width_of(const Extent& extent, const Scale& scale) {
    return static_cast<int>(std::ceil(scale.px_per_m * (extent.high.x() - extent.low.x())));
  }
  /// On the same side of all edges.
  [[nodiscard]] bool holds(std::span<const Vector2d> convex, const Vector2d& px) const {
    bool left = false;
    bool right = false;
    for (std::size_t i = 0; i < convex.size(); ++i) {
      const Vector2d a = scale_.to_px(convex[i]);
      const Vector2d edge = scale_.to_px(convex[(i + 1) % convex.size()]) - a;
      const Vector2d to = px - a;
      const double turn = edge.x() * to.y() - edge.y() * to.x();
      (turn > 0.0 ? left : right) = true;
    }
    return left != right;
  }

  Scale scale_;
  Image image_;
};

Rgb shade(double bottom_m) {
  const double share = std::clamp(bottom_m / 0.5, 0.0, 1.0);
  const auto grey = static_cast<std::uint8_t>(190.0 - 110.0 * share);
  return {grey, grey, grey};
}

void paint(Painter& painter, const sim::Object& object) {
  if (const auto* box = std::get_if<sim::Box>(&object.shape)) {
    const double bottom_m = box->center.z() - 0.5 * box->size.z();
    if (bottom_m < kCeilingM) {
      painter.fill(corners(*box), shade(bottom_m));
    }
  } else if (const auto* cylinder = std::get_if<sim::Cylinder>(&object.shape)) {
    painter.disc(cylinder->center.head<2>(), cylinder->radius_m,
                 shade(cylinder->center.z() - 0.5 * cylinder->height_m));
  } else if (const auto* ramp = std::get_if<sim::Ramp>(&object.shape)) {
    painter.fill(corners(*ramp), Rgb{220, 220, 190});
  } else if (const auto* mesh = std::get_if<sim::Mesh>(&object.shape)) {
    for (const Eigen::Vector3i& triangle : mesh->triangles) {
      std::array<Vector2d, 3> points;
      for (int i = 0; i < 3; ++i) {
        points[static_cast<std::size_t>(i)] =
            mesh->vertices[static_cast<std::size_t>(triangle[i])].head<2>();
      }
      painter.fill(points, shade(0.2));
    }
  }
}

void paint(Painter& painter, const sim::World& world) {
  for (const sim::Pit& pit : world.pits) {
    painter.fill(corners(pit), kPit);
  }
  for (const sim::Object& object : world.objects) {
    paint(painter, object);
  }
  for (const sim::Actor& actor : world.actors) {
    for (std::size_t i = 0; i < actor.path.size(); ++i) {
      painter.circle(actor.path[i].position, actor.radius_m, kActor);
      painter.line(actor.path[i].position, actor.path[i > 0 ? i - 1 : 0].position, kActor, 1.0);
    }
  }
  painter.circle(world.T_world_start.translation(), 0.25, kStart);
  if (world.goal) {
    painter.circle(*world.goal, 0.3, kStart);
    painter.circle(*world.goal, 0.1, kStart);
  }
}

void paint(Painter& painter, const TrialRecord& record) {
  for (std::size_t i = 1; i < record.truth.size(); ++i) {
    const TruthSample& from = record.truth[i - 1];
    const TruthSample& to = record.truth[i];
    painter.line(from.T_world_base.translation().head<2>(), to.T_world_base.translation().head<2>(),
                 drawing::colour_scale(std::abs(to.forward_mps) / kFastMps), 3.0);
  }
  for (std::size_t i = 1; i < record.truth.size(); ++i) {
    if (record.truth[i].collisions > record.truth[i - 1].collisions) {
      painter.disc(record.truth[i].T_world_base.translation().head<2>(), 0.08, kRed);
      painter.circle(record.truth[i].T_world_base.translation().head<2>(), 0.28, kRed);
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
    extent.add(sample.T_world_base.translation().head<2>());
  }
  extent.low.array() -= kBorderM;
  extent.high.array() += kBorderM;
  return extent;
}

}  // namespace

drawing::Image draw_paths(const sim::World& world, const TrialRecord& record,
                          const std::vector<EstimatedPath>& estimates) {
  Painter painter(extent_of(world, record));
  paint(painter, world);
  paint(painter, record);
  const geometry::SE3 T_world_map = geometry::to_se3(world.T_world_start);
  for (const EstimatedPath& estimate : estimates) {
    for (std::size_t i = 1; i < estimate.poses.size(); ++i) {
      painter.line((T_world_map * estimate.poses[i - 1].pose.translation()).head<2>(),
                   (T_world_map * estimate.poses[i].pose.translation()).head<2>(), estimate.colour,
                   1.0);
    }
  }
  return painter.take();
}

}  // namespace nodmap::trial
