// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/cloud_picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {
namespace {

using picture::Image;
using picture::Rgb;

constexpr Rgb kBackground{18, 20, 26};
constexpr Rgb kPathColour{255, 140, 40};
constexpr Rgb kOdometryColour{200, 60, 60};
constexpr Rgb kPaleColour{205, 210, 216};
constexpr int kWidth = 1600;
constexpr int kObliqueHeight = 950;
constexpr int kMaxTopHeight = 900;
constexpr float kNothing = std::numeric_limits<float>::infinity();

// The middle of the scene and its extent along three axes: the longest way in the plane, across it,
// and up. Stray points outside are drawn but do not shrink the rest.
struct Scene {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns, in map
  Eigen::Vector3d half_extent = Eigen::Vector3d::Ones();
};

// The direction in which the walls run, within a quarter turn: normals of walls at right angles to
// each other have one angle when it is taken four times.
double building_yaw(std::span<const RegisteredPoint> points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const RegisteredPoint& point : points) {
    const Eigen::Vector2d level = point.normal_map.head<2>().cast<double>();
    const double angle = 4.0 * std::atan2(level.y(), level.x());
    sum += level.squaredNorm() * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return 0.25 * std::atan2(sum.y(), sum.x());
}

// Where most of the points lie along one direction.
struct Extent {
  double low_m = 0.0;
  double high_m = 0.0;
};

Extent extent_along(std::span<const RegisteredPoint> points, const Eigen::Vector3d& direction) {
  std::vector<float> places;
  places.reserve(points.size());
  for (const RegisteredPoint& point : points) {
    places.push_back(direction.cast<float>().dot(point.p_map));
  }
  const double low_m = static_cast<double>(quantile(places, 0.015));
  const double high_m = static_cast<double>(quantile(std::move(places), 0.985));
  return {low_m, std::max(high_m, low_m + 1.0)};
}

Scene scene_of(std::span<const RegisteredPoint> points) {
  const auto turned = [](double yaw) {
    return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  };
  const auto length = [&points](const Eigen::Vector3d& direction) {
    const Extent extent = extent_along(points, direction);
    return extent.high_m - extent.low_m;
  };
  Scene scene;
  scene.axes = turned(building_yaw(points));
  if (length(scene.axes.col(1)) > length(scene.axes.col(0))) {
    scene.axes = scene.axes * turned(0.5 * geometry::kPi);
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Extent extent = extent_along(points, scene.axes.col(axis));
    middle[axis] = 0.5 * (extent.low_m + extent.high_m);
    scene.half_extent[axis] = 0.5 * (extent.high_m - extent.low_m);
  }
  scene.centre = scene.axes * middle;
  return scene;
}

// A place in the picture; depth orders what covers what and scales the size of points.
struct Pixel {
  double x = 0.0;
  double y = 0.0;
  double depth = 0.0;
};

struct Camera {
  Eigen::Vector3d p_map_eye = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_camera_map = Eigen::Matrix3d::Identity();  ///< right, down, ahead
  double focal_px = 1.0;  ///< perspective; orthographic: pixels per metre
  bool is_perspective = true;
  double centre_x = 0.0;
  double centre_y = 0.0;

  [[nodiscard]] std::optional<Pixel> project(const Eigen::Vector3d& p_map) const {
    const Eigen::Vector3d p = R_camera_map * (p_map - p_map_eye);
    if (!(p.z() > 0.1)) {
      return std::nullopt;
    }
    const double scale = is_perspective ? focal_px / p.z() : focal_px;
    return Pixel{centre_x + scale * p.x(), centre_y + scale * p.y(), p.z()};
  }

  [[nodiscard]] double pixels_per_m(double depth) const {
    return is_perspective ? focal_px / depth : focal_px;
  }
};

Eigen::Matrix3d looking_along(const Eigen::Vector3d& ahead, const Eigen::Vector3d& up) {
  const Eigen::Vector3d right = ahead.cross(up).normalized();
  Eigen::Matrix3d R_camera_map;
  R_camera_map << right.transpose(), ahead.cross(right).transpose(), ahead.transpose();
  return R_camera_map;
}

bool shows_all(const Camera& camera, const Scene& scene, int width, int height) {
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                               (corner & 4) != 0 ? 1 : -1);
    const auto pixel =
        camera.project(scene.centre + scene.axes * sign.cwiseProduct(scene.half_extent));
    if (!pixel || pixel->x < 0.0 || pixel->x > width || pixel->y < 0.0 || pixel->y > height) {
      return false;
    }
  }
  return true;
}

// From obliquely above, across the long axis, as near as shows everything.
Camera oblique_camera(const Scene& scene) {
  const double azimuth = geometry::deg_to_rad(-120.0);
  const double elevation = geometry::deg_to_rad(38.0);
  const Eigen::Vector3d back =
      scene.axes * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Camera camera;
  camera.R_camera_map = looking_along(-back, Eigen::Vector3d::UnitZ());
  camera.focal_px = 1.4 * kWidth;
  camera.centre_x = 0.5 * kWidth;
  camera.centre_y = 0.5 * kObliqueHeight;
  double distance_m = scene.half_extent.norm();
  do {
    distance_m *= 1.03;
    camera.p_map_eye = scene.centre + distance_m * back;
  } while (!shows_all(camera, scene, kWidth, kObliqueHeight) && distance_m < 1e5);
  return camera;
}

// From the top, the long axis to the right.
Camera top_camera(const Scene& scene) {
  Camera camera;
  camera.is_perspective = false;
  camera.R_camera_map = looking_along(-Eigen::Vector3d::UnitZ(), scene.axes.col(1));
  camera.focal_px = std::min(0.94 * kWidth / (2.0 * scene.half_extent.x()),
                             0.94 * kMaxTopHeight / (2.0 * scene.half_extent.y()));
  camera.p_map_eye = scene.centre + Eigen::Vector3d(0, 0, scene.half_extent.z() + 1000.0);
  camera.centre_x = 0.5 * kWidth;
  camera.centre_y = camera.focal_px * scene.half_extent.y() / 0.94;
  return camera;
}

int top_height(const Camera& camera) {
  return std::clamp(static_cast<int>(2.0 * camera.centre_y), 200, kMaxTopHeight);
}

// A picture with depths, so that near points cover far ones.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width),
        height_(height),
        colours_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kBackground),
        depths_(colours_.size(), kNothing) {}

  void splat(const Pixel& pixel, int radius_px, Rgb colour) {
    const int x0 = static_cast<int>(std::lround(pixel.x));
    const int y0 = static_cast<int>(std::lround(pixel.y));
    const auto depth = static_cast<float>(pixel.depth);
    for (int y = std::max(0, y0 - radius_px); y <= std::min(height_ - 1, y0 + radius_px); ++y) {
      for (int x = std::max(0, x0 - radius_px); x <= std::min(width_ - 1, x0 + radius_px); ++x) {
        if (depth < depths_[index(x, y)]) {
          depths_[index(x, y)] = depth;
          colours_[index(x, y)] = colour;
        }
      }
    }
  }

  // Darkens where something near stands beside something far (eye-dome lighting, Boucheny 2009):
  // edges show without knowing any surface. `scale_per_m` turns depth into shade.
  void paint(Image& image, int top, double scale_per_m) const {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const Rgb& colour = colours_[index(x, y)];
        const double light = std::exp(-scale_per_m * obscurance_m(x, y));
        image.set(x, top + y,
                  {shade(colour[0], light), shade(colour[1], light), shade(colour[2], light)});
      }
    }
  }

 private:
  static std::uint8_t shade(std::uint8_t value, double light) {
    return static_cast<std::uint8_t>(std::lround(light * static_cast<double>(value)));
  }

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  // How much nearer the surroundings are, metres, averaged; one far-off edge counts 1 m at most.
  [[nodiscard]] double obscurance_m(int x, int y) const {
    const float depth = depths_[index(x, y)];
    if (depth == kNothing) {
      return 0.0;
    }
    double sum_m = 0.0;
    for (const auto& [dx, dy] : kSurroundings) {
      const int u = x + dx;
      const int v = y + dy;
      if (u < 0 || v < 0 || u >= width_ || v >= height_) {
        continue;
      }
      const float nearer_m = depth - depths_[index(u, v)];
      sum_m += static_cast<double>(std::clamp(nearer_m, 0.0F, 1.0F)) / kSurroundings.size();
    }
    return sum_m;
  }

  static constexpr std::array<std::pair<int, int>, 8> kSurroundings{
      {{-2, 0}, {2, 0}, {0, -2}, {0, 2}, {-3, -3}, {3, -3}, {-3, 3}, {3, 3}}};

  int width_;
  int height_;
  std::vector<Rgb> colours_;
  std::vector<float> depths_;
};

Rgb lit(Rgb colour, const Eigen::Vector3f& normal) {
  const Eigen::Vector3f light = Eigen::Vector3f(0.35F, 0.25F, 0.9F).normalized();
  const float strength = normal.isZero() ? 0.85F : 0.62F + 0.38F * std::abs(normal.dot(light));
  for (std::uint8_t& value : colour) {
    value = static_cast<std::uint8_t>(std::lround(strength * static_cast<float>(value)));
  }
  return colour;
}

bool faces(const Camera& camera, const RegisteredPoint& point) {
  const Eigen::Vector3d to_eye =
      camera.is_perspective ? Eigen::Vector3d(camera.p_map_eye - point.p_map.cast<double>())
                            : Eigen::Vector3d(-camera.R_camera_map.row(2).transpose());
  return point.normal_map.cast<double>().dot(to_eye) >= 0.0;
}

// Pixels on each side of a point's middle: as large as `size_m` in the scene.
int splat_radius(const Camera& camera, const Pixel& pixel, double size_m) {
  return std::clamp(static_cast<int>(0.5 * size_m * camera.pixels_per_m(pixel.depth)), 1, 4);
}

void draw_points(Canvas& canvas, const Camera& camera, std::span<const RegisteredPoint> points) {
  constexpr double kPointSizeM = 0.05;
  // The darkest colours of the scale would drown in the background.
  constexpr double kDarkest = 0.25;
  const HeightRange heights = height_range(points);
  // What is no surface and hangs under the ceiling would cover what is below.
  const float ceiling_m = heights.high_m - 0.1F * (heights.high_m - heights.low_m);
  for (const RegisteredPoint& point : points) {
    const auto pixel = camera.project(point.p_map.cast<double>());
    if (!pixel || !faces(camera, point) ||
        (point.normal_map.isZero() && point.p_map.z() > ceiling_m)) {
      continue;
    }
    const Rgb colour = picture::colour_scale(
        kDarkest + (1.0 - kDarkest) * std::clamp(heights.place(point.p_map.z()), 0.0, 1.0));
    canvas.splat(*pixel, splat_radius(camera, *pixel, kPointSizeM), lit(colour, point.normal_map));
  }
}

void draw_way(Image& image, const Camera& camera, int top, std::span<const Eigen::Vector3d> way,
              Rgb colour) {
  for (std::size_t i = 1; i < way.size(); ++i) {
    const auto from = camera.project(way[i - 1]);
    const auto to = camera.project(way[i]);
    if (from && to) {
      image.draw_line(from->x, top + from->y, to->x, top + to->y, colour, 3.0);
    }
  }
}

void draw_keyframes(Image& image, const Camera& camera, int top,
                    std::span<const Eigen::Vector3d> keyframes) {
  for (const Eigen::Vector3d& p_map : keyframes) {
    if (const auto pixel = camera.project(p_map)) {
      image.fill_disc(pixel->x, top + pixel->y, 7.0, picture::kWhite);
      image.fill_disc(pixel->x, top + pixel->y, 5.0, kPathColour);
    }
  }
}

// One metre, so that the picture has a scale.
void draw_scale(Image& image, const Camera& camera, int bottom, Rgb colour) {
  image.fill_rectangle(20, bottom - 24, static_cast<int>(camera.focal_px), 6, colour);
}

}  // namespace

Image draw_map(std::span<const RegisteredPoint> points, const PicturePath& path) {
  const Scene scene = scene_of(points);
  const Camera oblique = oblique_camera(scene);
  const Camera top = top_camera(scene);
  const int height = kObliqueHeight + top_height(top);
  Image image(kWidth, height, kBackground);

  Canvas upper(kWidth, kObliqueHeight);
  draw_points(upper, oblique, points);
  upper.paint(image, 0, 2.0);
  draw_way(image, oblique, 0, path.corrected, kPathColour);
  draw_keyframes(image, oblique, 0, path.keyframes);

  Canvas lower(kWidth, top_height(top));
  draw_points(lower, top, points);
  lower.paint(image, kObliqueHeight, 1.0);
  draw_way(image, top, kObliqueHeight, path.corrected, kPathColour);
  draw_keyframes(image, top, kObliqueHeight, path.keyframes);
  draw_scale(image, top, height, picture::kWhite);
  return image;
}

Image draw_path(std::span<const RegisteredPoint> points, const PicturePath& path) {
  const Camera camera = top_camera(scene_of(points));
  Image image(kWidth, top_height(camera));
  for (const RegisteredPoint& point : points) {
    if (const auto pixel = camera.project(point.p_map.cast<double>())) {
      image.set(static_cast<int>(pixel->x), static_cast<int>(pixel->y), kPaleColour);
    }
  }
  draw_way(image, camera, 0, path.odometry, kOdometryColour);
  draw_way(image, camera, 0, path.corrected, kPathColour);
  draw_keyframes(image, camera, 0, path.keyframes);
  draw_scale(image, camera, image.height(), picture::kBlack);
  return image;
}

}  // namespace nodmap::slam6d
