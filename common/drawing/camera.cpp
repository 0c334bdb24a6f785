// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/statistics/quantile.hpp"

namespace nodmap::drawing {
namespace {

// Fraction of the points at each end of an axis that the scale ignores, so that a few stray points
// do not make everything else small.
constexpr double kStrayShare = 0.004;
constexpr double kFilled = 0.95;  // of the image, between its margins

// The centre of the scene and its half extents along the building's long axis, across it, and up.
struct Scene {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns, in map
  Eigen::Vector3d half_extent = Eigen::Vector3d::Ones();
};

// The direction of the walls, rad, modulo a right angle. Normals of perpendicular walls agree when
// their angles are multiplied by four.
double building_yaw(std::span<const DrawnPoint> points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const DrawnPoint& point : points) {
    const Eigen::Vector2d level = point.normal_map.head<2>().cast<double>();
    const double angle = 4.0 * std::atan2(level.y(), level.x());
    sum += level.squaredNorm() * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return 0.25 * std::atan2(sum.y(), sum.x());
}

// The interval that contains most values.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

Interval extent_along(std::span<const DrawnPoint> points, const Eigen::Vector3d& direction) {
  std::vector<float> places;
  places.reserve(points.size());
  for (const DrawnPoint& point : points) {
    places.push_back(direction.cast<float>().dot(point.p_map));
  }
  const double low = static_cast<double>(statistics::quantile(places, kStrayShare));
  const double high =
      static_cast<double>(statistics::quantile(std::move(places), 1.0 - kStrayShare));
  return {low, std::max(high, low + 1.0)};
}

Scene scene_of(std::span<const DrawnPoint> points) {
  const auto turned = [](double yaw) {
    return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  };
  const auto length = [&points](const Eigen::Vector3d& direction) {
    const Interval extent = extent_along(points, direction);
    return extent.high - extent.low;
  };
  Scene scene;
  scene.axes = turned(building_yaw(points));
  if (length(scene.axes.col(1)) > length(scene.axes.col(0))) {
    scene.axes = scene.axes * turned(0.5 * geometry::kPi);
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Interval extent = extent_along(points, scene.axes.col(axis));
    middle[axis] = 0.5 * (extent.low + extent.high);
    scene.half_extent[axis] = 0.5 * (extent.high - extent.low);
  }
  scene.centre = scene.axes * middle;
  return scene;
}

Eigen::Matrix3d looking_along(const Eigen::Vector3d& ahead, const Eigen::Vector3d& up) {
  const Eigen::Vector3d right = ahead.cross(up).normalized();
  Eigen::Matrix3d R_camera_map;
  R_camera_map << right.transpose(), ahead.cross(right).transpose(), ahead.transpose();
  return R_camera_map;
}

// Zooms and shifts the camera so that the visible points fill the image.
Camera fitted(Camera camera, std::span<const DrawnPoint> points, const ImageSize& size) {
  camera.focal_px = 1.0;
  camera.centre_x = camera.centre_y = 0.0;
  std::vector<float> xs;
  std::vector<float> ys;
  for (const DrawnPoint& point : points) {
    const auto pixel = camera.project(point.p_map.cast<double>());
    if (pixel && camera.faces(point)) {
      xs.push_back(static_cast<float>(pixel->x));
      ys.push_back(static_cast<float>(pixel->y));
    }
  }
  const auto ends = [](std::vector<float>& values) {
    return Interval{static_cast<double>(statistics::quantile(values, kStrayShare)),
                    static_cast<double>(statistics::quantile(values, 1.0 - kStrayShare))};
  };
  const Interval x = ends(xs);
  const Interval y = ends(ys);
  camera.focal_px = kFilled * std::min(size.width / std::max(x.high - x.low, 1e-3),
                                       size.height / std::max(y.high - y.low, 1e-3));
  camera.centre_x = 0.5 * size.width - camera.focal_px * 0.5 * (x.low + x.high);
  camera.centre_y = 0.5 * size.height - camera.focal_px * 0.5 * (y.low + y.high);
  return camera;
}

}  // namespace

std::optional<Pixel> Camera::project(const Eigen::Vector3d& p_map) const {
  const Eigen::Vector3d p = R_camera_map * (p_map - p_map_camera);
  if (!(p.z() > 0.1)) {
    return std::nullopt;
  }
  const double scale = pixels_per_m(p.z());
  return Pixel{centre_x + scale * p.x(), centre_y + scale * p.y(), p.z()};
}

bool Camera::faces(const DrawnPoint& point) const {
  const Eigen::Vector3d to_camera = is_perspective
                                        ? Eigen::Vector3d(p_map_camera - point.p_map.cast<double>())
                                        : Eigen::Vector3d(-R_camera_map.row(2).transpose());
  return point.normal_map.cast<double>().dot(to_camera) >= 0.0;
}

Camera oblique_camera(std::span<const DrawnPoint> points, const ImageSize& size) {
  const double azimuth = geometry::deg_to_rad(-120.0);
  const double elevation = geometry::deg_to_rad(38.0);
  const Scene scene = scene_of(points);
  const Eigen::Vector3d back =
      scene.axes * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Camera camera;
  camera.R_camera_map = looking_along(-back, Eigen::Vector3d::UnitZ());
  camera.p_map_camera = scene.centre + 3.0 * scene.half_extent.norm() * back;
  return fitted(camera, points, size);
}

Camera top_camera(std::span<const DrawnPoint> points, const ImageSize& size) {
  constexpr double kAboveEverythingM = 1000.0;
  const Scene scene = scene_of(points);
  Camera camera;
  camera.is_perspective = false;
  camera.R_camera_map = looking_along(-Eigen::Vector3d::UnitZ(), scene.axes.col(1));
  camera.p_map_camera = scene.centre + kAboveEverythingM * Eigen::Vector3d::UnitZ();
  return fitted(camera, points, size);
}

}  // namespace nodmap::drawing
