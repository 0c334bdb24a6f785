// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/slam6d/picture_camera.hpp"

namespace nodmap::slam6d {

/// A picture with depths: near points cover far ones.
class DepthCanvas {
 public:
  using Rgb = std::array<std::uint8_t, 3>;

  DepthCanvas(const PictureSize& size, Rgb background);

  /// A square point, `radius_px` to each side of its middle.
  void splat(const Pixel& pixel, int radius_px, Rgb colour);

  /// The colour of a pixel, darkened where something near stands beside something far (eye-dome
  /// lighting, Boucheny 2009): edges show without any surface being known. `shade_per_m` turns the
  /// difference in depth into shade.
  [[nodiscard]] Rgb shaded(int x, int y, double shade_per_m) const;

  [[nodiscard]] const PictureSize& size() const { return size_; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const;
  [[nodiscard]] double obscurance_m(int x, int y) const;

  PictureSize size_;
  std::vector<Rgb> colours_;
  std::vector<float> depths_;
};

}  // namespace nodmap::slam6d
