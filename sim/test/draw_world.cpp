// SPDX-License-Identifier: BSD-3-Clause
// draw_world WORLD.yaml|random:SEED OUT.png: a world seen from above, brighter where it is higher.
// Reddish: what the robot can hit; blue: start and goal; pink: actors' ways; grey: pits.
#include <algorithm>
#include <iostream>
#include <string>

#include "common/drawing/image.hpp"
#include "sim/collision.hpp"
#include "sim/random_world.hpp"
#include "sim/ray_caster.hpp"
#include "sim/world_file.hpp"

namespace nodmap::sim {
namespace {

constexpr double kPixelsPerM = 50.0;
constexpr double kCeilingM = 2.1;  // looked at from below it

struct Frame {
  Eigen::Vector2d min;
  Eigen::Vector2d size;

  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& p) const {
    return {kPixelsPerM * (p.x() - min.x()), kPixelsPerM * (min.y() + size.y() - p.y())};
  }
};

Frame frame_of(const World& world) {
  Bounds bounds;
  for (const Object& object : world.objects) {
    if (const auto* box = std::get_if<Box>(&object.shape)) {
      bounds.extend(bounds_of(RayBox(*box)));
    }
  }
  const Eigen::Vector2d margin(0.3, 0.3);
  return {bounds.min.head<2>() - margin, (bounds.max - bounds.min).head<2>() + 2.0 * margin};
}

void draw(const World& world, const std::string& file) {
  const Frame frame = frame_of(world);
  drawing::Image image(static_cast<int>(kPixelsPerM * frame.size.x()),
                       static_cast<int>(kPixelsPerM * frame.size.y()));
  const RayCaster caster(world);
  PlantParams pin;  // a needle of the robot's height
  pin.body_length_m = pin.body_width_m = 1e-3;
  const Collision collision(world, pin);
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      const Eigen::Vector2d p(frame.min.x() + (u + 0.5) / kPixelsPerM,
                              frame.min.y() + frame.size.y() - (v + 0.5) / kPixelsPerM);
      const auto hit =
          caster.cast({{p.x(), p.y(), kCeilingM}, -Eigen::Vector3d::UnitZ()}, 2.0 * kCeilingM);
      const double height_m = hit ? kCeilingM - hit->distance_m : 0.0;
      const auto level = [](double share) {
        return static_cast<std::uint8_t>(std::clamp(255.0 * share, 0.0, 255.0));
      };
      const bool solid = !collision.touched({{p.x(), p.y(), 0.0}, 0.0}).empty();
      const double shade = height_m < -1e-6 ? 0.5 + 0.3 * height_m : 1.0 - 0.4 * height_m;
      image.set(
          u, v,
          {level(shade), level(solid ? 0.6 * shade : shade), level(solid ? 0.5 * shade : shade)});
    }
  }
  for (const Actor& actor : world.actors) {
    for (std::size_t i = 0; i + 1 < actor.path.size(); ++i) {
      const Eigen::Vector2d a = frame.pixel(actor.path[i].position);
      const Eigen::Vector2d b = frame.pixel(actor.path[i + 1].position);
      image.draw_line(a.x(), a.y(), b.x(), b.y(), {230, 60, 200});
    }
    const Eigen::Vector2d a = frame.pixel(actor.position(0.0));
    image.draw_circle(a.x(), a.y(), kPixelsPerM * actor.radius_m, {230, 60, 200});
  }
  const Eigen::Vector2d start = frame.pixel(world.T_world_start.translation());
  const Eigen::Vector2d nose = frame.pixel(world.T_world_start * Eigen::Vector2d(0.4, 0.0));
  image.draw_circle(start.x(), start.y(), kPixelsPerM * 0.28, {0, 0, 255});
  image.draw_line(start.x(), start.y(), nose.x(), nose.y(), {0, 0, 255}, 2.0);
  if (world.goal) {
    const Eigen::Vector2d goal = frame.pixel(*world.goal);
    image.fill_disc(goal.x(), goal.y(), 6.0, {0, 0, 255});
  }
  image.write_png(file);
}

}  // namespace
}  // namespace nodmap::sim

int main(int argc, char** argv) {
  using namespace nodmap::sim;
  if (argc != 3) {
    std::cerr << "usage: draw_world WORLD.yaml|random:SEED OUT.png\n";
    return 2;
  }
  try {
    const std::string name = argv[1];
    draw(name.starts_with("random:") ? random_clutter(std::stoull(name.substr(7)))
                                     : load_world(name),
         argv[2]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
