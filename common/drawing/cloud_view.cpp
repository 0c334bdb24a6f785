// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/cloud_view.hpp"

#include <algorithm>
#include <cmath>

#include "common/drawing/camera.hpp"
#include "common/drawing/depth_canvas.hpp"

namespace nodmap::drawing {
namespace {

constexpr Rgb kBackground{18, 20, 26};
constexpr Rgb kPathColour{255, 140, 40};
constexpr Rgb kOdometryColour{200, 60, 60};
constexpr Rgb kPaleColour{205, 210, 216};
constexpr ImageSize kObliqueSize{.width = 1600, .height = 950};
constexpr ImageSize kTopSize{.width = 1600, .height = 750};

Rgb lit(Rgb colour, const Eigen::Vector3f& normal) {
  const Eigen::Vector3f light = Eigen::Vector3f(0.35F, 0.25F, 0.9F).normalized();
  const float strength = normal.isZero() ? 0.85F : 0.62F + 0.38F * std::abs(normal.dot(light));
  for (std::uint8_t& value : colour) {
    value = static_cast<std::uint8_t>(std::lround(strength * static_cast<float>(value)));
  }
  return colour;
}

// Half the width, in pixels, of a point that is `size_m` wide in the scene.
int splat_radius(const Camera& camera, const Pixel& pixel, double size_m) {
  return std::clamp(static_cast<int>(0.5 * size_m * camera.pixels_per_m(pixel.depth)), 1, 4);
}

void draw_points(DepthCanvas& canvas, const Camera& camera, std::span<const DrawnPoint> points) {
  constexpr double kPointSizeM = 0.05;
  // The darkest colours of the scale would not stand out from the background.
  constexpr double kDarkest = 0.25;
  const HeightRange heights = height_range(points);
  // Points without a normal near the ceiling would cover what is below.
  const float ceiling_m = heights.high_m - 0.1F * (heights.high_m - heights.low_m);
  for (const DrawnPoint& point : points) {
    const auto pixel = camera.project(point.p_map.cast<double>());
    if (!pixel || !camera.faces(point) ||
        (point.normal_map.isZero() && point.p_map.z() > ceiling_m)) {
      continue;
    }
    const Rgb colour = colour_scale(
        kDarkest + (1.0 - kDarkest) * std::clamp(heights.place(point.p_map.z()), 0.0, 1.0));
    canvas.splat(*pixel, splat_radius(camera, *pixel, kPointSizeM), lit(colour, point.normal_map));
  }
}

void paint(const DepthCanvas& canvas, Image& image, int top, double shade_per_m) {
  for (int y = 0; y < canvas.size().height; ++y) {
    for (int x = 0; x < canvas.size().width; ++x) {
      image.set(x, top + y, canvas.shaded(x, y, shade_per_m));
    }
  }
}

void draw_path(Image& image, const Camera& camera, int top, std::span<const Eigen::Vector3d> path,
               Rgb colour) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const auto from = camera.project(path[i - 1]);
    const auto to = camera.project(path[i]);
    if (from && to) {
      image.draw_line(from->x, top + from->y, to->x, top + to->y, colour, 3.0);
    }
  }
}

void draw_keyframes(Image& image, const Camera& camera, int top,
                    std::span<const Eigen::Vector3d> keyframes) {
  for (const Eigen::Vector3d& p_map : keyframes) {
    if (const auto pixel = camera.project(p_map)) {
      image.fill_disc(pixel->x, top + pixel->y, 7.0, kWhite);
      image.fill_disc(pixel->x, top + pixel->y, 5.0, kPathColour);
    }
  }
}

// Draws a scale bar of one metre.
void draw_scale(Image& image, const Camera& camera, int bottom, Rgb colour) {
  image.fill_rectangle(20, bottom - 24, static_cast<int>(camera.focal_px), 6, colour);
}

}  // namespace

Image draw_cloud(std::span<const DrawnPoint> points, const DrawnPath& path) {
  const int height = kObliqueSize.height + kTopSize.height;
  Image image(kObliqueSize.width, height, kBackground);

  const Camera oblique = oblique_camera(points, kObliqueSize);
  DepthCanvas upper(kObliqueSize, kBackground);
  draw_points(upper, oblique, points);
  paint(upper, image, 0, 2.0);
  draw_path(image, oblique, 0, path.corrected, kPathColour);
  draw_keyframes(image, oblique, 0, path.keyframes);

  const Camera top = top_camera(points, kTopSize);
  DepthCanvas lower(kTopSize, kBackground);
  draw_points(lower, top, points);
  paint(lower, image, kObliqueSize.height, 1.0);
  draw_path(image, top, kObliqueSize.height, path.corrected, kPathColour);
  draw_keyframes(image, top, kObliqueSize.height, path.keyframes);
  draw_scale(image, top, height, kWhite);
  return image;
}

Image draw_path_on_cloud(std::span<const DrawnPoint> points, const DrawnPath& path) {
  const Camera camera = top_camera(points, kTopSize);
  Image image(kTopSize.width, kTopSize.height);
  for (const DrawnPoint& point : points) {
    if (const auto pixel = camera.project(point.p_map.cast<double>())) {
      image.set(static_cast<int>(pixel->x), static_cast<int>(pixel->y), kPaleColour);
    }
  }
  draw_path(image, camera, 0, path.odometry, kOdometryColour);
  draw_path(image, camera, 0, path.corrected, kPathColour);
  draw_keyframes(image, camera, 0, path.keyframes);
  draw_scale(image, camera, image.height(), kBlack);
  return image;
}

}  // namespace nodmap::drawing
