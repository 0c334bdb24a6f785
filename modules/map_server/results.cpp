// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/results.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace nodmap::map_server {
namespace {

constexpr int kSizePx = 1000;
constexpr drawing::Rgb kRing{225, 225, 225};
constexpr drawing::Rgb kFifthRing{185, 185, 185};
constexpr drawing::Rgb kStructure{35, 95, 190};
constexpr drawing::Rgb kObstacle{215, 40, 35};
constexpr drawing::Rgb kRobot{60, 60, 60};

// Distance from the centre of the image to its border, in whole metres, chosen so that nine points
// in ten fit. To fit all, a few points at the end of a corridor would make the others tiny.
double reach_m(const ExtendedScan& obstacles, const ExtendedScan& structure) {
  std::vector<double> distances;
  for (const ExtendedScan* map : {&obstacles, &structure}) {
    for (const EgoPoint& point : map->points()) {
      if (point.valid) {
        distances.push_back(point.distance_m);
      }
    }
  }
  std::ranges::sort(distances);
  return distances.empty() ? 2.0 : std::ceil(distances[(distances.size() * 9) / 10] + 0.2);
}

class Canvas {
 public:
  explicit Canvas(double reach_m) : image_(kSizePx, kSizePx), px_per_m_(0.5 * kSizePx / reach_m) {
    for (int ring_m = 1; ring_m <= static_cast<int>(reach_m); ++ring_m) {
      image_.draw_circle(kMiddle, kMiddle, ring_m * px_per_m_,
                         ring_m % 5 == 0 ? kFifthRing : kRing);
    }
  }

  void draw_points(const ExtendedScan& map, double radius_px, drawing::Rgb colour) {
    for (const EgoPoint& point : map.points()) {
      if (point.valid) {
        image_.fill_disc(u(point.p_base), v(point.p_base), radius_px, colour);
      }
    }
  }

  void draw_robot(const robot::Footprint& robot) {
    const Eigen::Vector2d front_left(robot.half_length_m, robot.half_width_m);
    image_.fill_rectangle(static_cast<int>(u(front_left)), static_cast<int>(v(front_left)),
                          static_cast<int>(std::lround(2.0 * robot.half_width_m * px_per_m_)),
                          static_cast<int>(std::lround(2.0 * robot.half_length_m * px_per_m_)),
                          kRobot);
    const Eigen::Vector2d nose(2.0 * robot.half_length_m, 0.0);
    image_.draw_line(kMiddle, kMiddle, u(nose), v(nose), kRobot, 2.0);
  }

  [[nodiscard]] drawing::Image take() && { return std::move(image_); }

 private:
  static constexpr double kMiddle = 0.5 * kSizePx;

  // Ahead is up, so left is left.
  [[nodiscard]] double u(const Eigen::Vector2d& p) const { return kMiddle - p.y() * px_per_m_; }
  [[nodiscard]] double v(const Eigen::Vector2d& p) const { return kMiddle - p.x() * px_per_m_; }

  drawing::Image image_;
  double px_per_m_;
};

}  // namespace

drawing::Image draw_maps(const ExtendedScan& obstacles, const ExtendedScan& structure,
                         const robot::Footprint& robot) {
  Canvas canvas(reach_m(obstacles, structure));
  canvas.draw_robot(robot);
  canvas.draw_points(structure, 4.0, kStructure);
  canvas.draw_points(obstacles, 2.5, kObstacle);
  return std::move(canvas).take();
}

}  // namespace nodmap::map_server
