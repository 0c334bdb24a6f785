// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "common/drawing/camera.hpp"
#include "common/drawing/image.hpp"

namespace nodmap::drawing {

/// An image with depths: near points cover far ones.
class DepthCanvas {
 public:
  DepthCanvas(const ImageSize& size, Rgb background);

  /// A square point, `radius_px` to each side of its middle.
  void splat(const Pixel& pixel, int radius_px, Rgb colour);

  /// The colour of a pixel, darkened where near points are beside far ones (EDL shading,
  /// Boucheny 2009), which shows edges without normals. `shade_per_m` converts the difference in
  /// depth to shade.
  [[nodiscard]] Rgb shaded(int x, int y, double shade_per_m) const;

  [[nodiscard]] const ImageSize& size() const { return size_; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const;
  [[nodiscard]] double obscurance_m(int x, int y) const;

  ImageSize size_;
  std::vector<Rgb> colours_;
  std::vector<float> depths_;
};

}  // namespace nodmap::drawing
