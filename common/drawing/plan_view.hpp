// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "common/drawing/image.hpp"

namespace nodmap::drawing {

/// An axis-aligned rectangle in the plane, metres; empty at first.
struct Extent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);

  void add(const Eigen::Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void grow(double border_m) {
    low.array() -= border_m;
    high.array() += border_m;
  }
  [[nodiscard]] bool is_empty() const { return low.x() > high.x(); }
  [[nodiscard]] Eigen::Vector2d size() const { return high - low; }
};

/// The scale, in pixels per metre, at which the longer side of the extent has `max_px` pixels; at
/// most `max_px_per_m`.
[[nodiscard]] double fitting_scale(const Extent& extent, double max_px, double max_px_per_m);

/// A rectangular grid of cells; cell (0, 0) is at the lower left.
struct Grid {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< lower left corner of cell (0, 0), metres
  double cell_size_m = 0.05;
  int width = 0;
  int height = 0;
  std::function<Rgb(int x, int y)> colour;
};

struct LegendEntry {
  std::string text;
  Rgb colour = kBlack;
};

/// An image in metres, seen from above: x to the right, y up. What lies outside is cut off.
class PlanView {
 public:
  /// Shows `extent`; an empty one becomes a square metre about the origin. The scale is smaller
  /// than `px_per_m` if the longer side would have more than 20,000 pixels.
  PlanView(const Extent& extent, double px_per_m, Rgb background = kWhite);

  void draw_grid(const Grid& grid);
  void draw_points(std::span<const Eigen::Vector2d> points, double radius_px, Rgb colour);
  void draw_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Rgb colour,
                 double width_px);
  void draw_path(std::span<const Eigen::Vector2d> path, Rgb colour, double width_px);
  /// Corners in order, either way round.
  void fill_convex(std::span<const Eigen::Vector2d> corners, Rgb colour);
  /// Fills a disc of at least 1.5 pixels radius, so that it is visible.
  void fill_disc(const Eigen::Vector2d& center, double radius_m, Rgb colour);
  void draw_circle(const Eigen::Vector2d& center, double radius_m, Rgb colour);

  /// Marks the start of a path with a disc, its end with a square.
  void draw_start(const Eigen::Vector2d& p, Rgb colour);
  void draw_end(const Eigen::Vector2d& p, Rgb colour);
  /// Draws a scale bar with its length, at the lower left: 1, 2 or 5 times a power of ten metres.
  void draw_scale_bar();
  /// Draws the legend at the upper left: a coloured line and a text for each entry.
  void draw_legend(std::span<const LegendEntry> entries);

  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& p) const {
    return {px_per_m_ * (p.x() - low_.x()), image_.height() - px_per_m_ * (p.y() - low_.y())};
  }
  [[nodiscard]] double px_per_m() const { return px_per_m_; }
  [[nodiscard]] const Image& image() const { return image_; }
  [[nodiscard]] Image take() && { return std::move(image_); }

 private:
  Eigen::Vector2d low_;
  double px_per_m_;
  Image image_;
};

/// Writes a text in black with its upper left corner at (x, y), in capitals of 5 x 3 dots of 2 x 2
/// pixels; characters other than letters, digits and .,:-+/%() become spaces.
void draw_text(Image& image, int x, int y, const std::string& text);

}  // namespace nodmap::drawing
