// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "common/picture/image.hpp"
#include "modules/slam6d/picture_camera.hpp"

namespace nodmap::slam6d {

/// A picture with depths: near points cover far ones.
class DepthCanvas {
 public:
  DepthCanvas(const PictureSize& size, picture::Rgb background);

  /// A square point, `radius_px` to each side of its middle.
  void splat(const Pixel& pixel, int radius_px, picture::Rgb colour);

  /// Paints into `image` from row `top` on, and darkens where something near stands beside
  /// something far (eye-dome lighting, Boucheny 2009): edges show without any surface being known.
  /// `shade_per_m` turns the difference in depth into shade.
  void paint(picture::Image& image, int top, double shade_per_m) const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const;
  [[nodiscard]] double obscurance_m(int x, int y) const;

  PictureSize size_;
  std::vector<picture::Rgb> colours_;
  std::vector<float> depths_;
};

}  // namespace nodmap::slam6d
