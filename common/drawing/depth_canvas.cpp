// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/depth_canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace nodmap::drawing {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

// The neighbours whose depths are compared with that of a pixel.
constexpr std::array<std::pair<int, int>, 8> kSurroundings{
    {{-2, 0}, {2, 0}, {0, -2}, {0, 2}, {-3, -3}, {3, -3}, {-3, 3}, {3, 3}}};

}  // namespace

DepthCanvas::DepthCanvas(const ImageSize& size, Rgb background)
    : size_(size),
      colours_(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height),
               background),
      depths_(colours_.size(), kNothing) {}

void DepthCanvas::splat(const Pixel& pixel, int radius_px, Rgb colour) {
  // A far-away or non-finite position must not be converted to int: that is undefined behaviour.
  if (!(std::abs(pixel.x) < 1e6 && std::abs(pixel.y) < 1e6)) {
    return;
  }
  const int x0 = static_cast<int>(std::lround(pixel.x));
  const int y0 = static_cast<int>(std::lround(pixel.y));
  const auto depth = static_cast<float>(pixel.depth);
  const int bottom = std::min(size_.height - 1, y0 + radius_px);
  const int right = std::min(size_.width - 1, x0 + radius_px);
  for (int y = std::max(0, y0 - radius_px); y <= bottom; ++y) {
    for (int x = std::max(0, x0 - radius_px); x <= right; ++x) {
      if (depth < depths_[index(x, y)]) {
        depths_[index(x, y)] = depth;
        colours_[index(x, y)] = colour;
      }
    }
  }
}

Rgb DepthCanvas::shaded(int x, int y, double shade_per_m) const {
  Rgb colour = colours_[index(x, y)];
  const double hidden_m = obscurance_m(x, y);
  if (hidden_m == 0.0) {
    return colour;
  }
  const double light = std::exp(-shade_per_m * hidden_m);
  for (std::uint8_t& value : colour) {
    value = static_cast<std::uint8_t>(std::lround(light * static_cast<double>(value)));
  }
  return colour;
}

std::size_t DepthCanvas::index(int x, int y) const {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
         static_cast<std::size_t>(x);
}

// How much nearer to the camera the neighbours are on average, metres. Each difference counts as at
// most 1 m.
double DepthCanvas::obscurance_m(int x, int y) const {
  const float depth = depths_[index(x, y)];
  if (depth == kNothing) {
    return 0.0;
  }
  double sum_m = 0.0;
  for (const auto& [dx, dy] : kSurroundings) {
    const int u = x + dx;
    const int v = y + dy;
    if (u < 0 || v < 0 || u >= size_.width || v >= size_.height) {
      continue;
    }
    const float nearer_m = depth - depths_[index(u, v)];
    sum_m += static_cast<double>(std::clamp(nearer_m, 0.0F, 1.0F)) / kSurroundings.size();
  }
  return sum_m;
}

}  // namespace nodmap::drawing
