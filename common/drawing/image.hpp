// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace nodmap::drawing {

using Rgb = std::array<std::uint8_t, 3>;

inline constexpr Rgb kWhite{255, 255, 255};
inline constexpr Rgb kBlack{0, 0, 0};

/// A colour image. Pixel (0, 0) is at the top left; drawing outside is cut off.
class Image {
 public:
  Image(int width, int height, Rgb background = kWhite);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Rgb at(int x, int y) const;

  void set(int x, int y, Rgb colour);
  void fill_rectangle(int x, int y, int width, int height, Rgb colour);
  void draw_line(double x0, double y0, double x1, double y1, Rgb colour, double width_px = 1.0);
  void fill_disc(double x, double y, double radius_px, Rgb colour);
  void draw_circle(double x, double y, double radius_px, Rgb colour);

  /// Throws std::runtime_error naming the file.
  void write_png(const std::filesystem::path& file) const;

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
};

/// A colour scale that is even in lightness and safe for the colour-blind (after viridis): 0 dark
/// blue, 1 yellow; clamped.
[[nodiscard]] Rgb colour_scale(double value);

}  // namespace nodmap::drawing
