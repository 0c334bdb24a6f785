// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/plan_view.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

namespace nodmap::drawing {
namespace {

using Eigen::Vector2d;

constexpr int kMarginPx = 12;
constexpr int kLineHeightPx = 16;
constexpr int kGlyphWidth = 3;
constexpr int kGlyphHeight = 5;

// A character of five rows by three dots: one octal digit per row from the top, the highest bit at
// the left.
struct Glyph {
  char character;
  std::string_view rows;
};
constexpr std::array kGlyphs{
    Glyph{'0', "75557"}, Glyph{'1', "26227"}, Glyph{'2', "71747"}, Glyph{'3', "71717"},
    Glyph{'4', "55711"}, Glyph{'5', "74717"}, Glyph{'6', "74757"}, Glyph{'7', "71122"},
    Glyph{'8', "75757"}, Glyph{'9', "75717"}, Glyph{'A', "25755"}, Glyph{'B', "65656"},
    Glyph{'C', "34443"}, Glyph{'D', "65556"}, Glyph{'E', "74647"}, Glyph{'F', "74644"},
    Glyph{'G', "34553"}, Glyph{'H', "55755"}, Glyph{'I', "72227"}, Glyph{'J', "11152"},
    Glyph{'K', "55655"}, Glyph{'L', "44447"}, Glyph{'M', "57755"}, Glyph{'N', "65555"},
    Glyph{'O', "25552"}, Glyph{'P', "65644"}, Glyph{'Q', "25563"}, Glyph{'R', "65655"},
    Glyph{'S', "34216"}, Glyph{'T', "72222"}, Glyph{'U', "55557"}, Glyph{'V', "55552"},
    Glyph{'W', "55775"}, Glyph{'X', "55255"}, Glyph{'Y', "55222"}, Glyph{'Z', "71247"},
    Glyph{'.', "00002"}, Glyph{',', "00024"}, Glyph{':', "02020"}, Glyph{'-', "00700"},
    Glyph{'+', "02720"}, Glyph{'/', "11244"}, Glyph{'%', "51245"}, Glyph{'(', "12221"},
    Glyph{')', "42224"}};

// Whether a point is on the same side of all edges.
bool is_inside(std::span<const Vector2d> convex, const Vector2d& p) {
  bool left = false;
  bool right = false;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d edge = convex[(i + 1) % convex.size()] - convex[i];
    const Vector2d to_p = p - convex[i];
    (edge.x() * to_p.y() - edge.y() * to_p.x() > 0.0 ? left : right) = true;
  }
  return left != right;
}

Extent or_square_metre(Extent extent) {
  if (extent.is_empty()) {
    extent.add({-0.5, -0.5});
    extent.add({0.5, 0.5});
  }
  return extent;
}

constexpr double kMaxPx = 20'000.0;  // of a side

int pixels(double size_m, double px_per_m) {
  return static_cast<int>(std::ceil(std::clamp(px_per_m * size_m, 1.0, kMaxPx)));
}

}  // namespace

double fitting_scale(const Extent& extent, double max_px, double max_px_per_m) {
  const double longer_m = or_square_metre(extent).size().maxCoeff();
  return longer_m > 0.0 ? std::min(max_px_per_m, max_px / longer_m) : max_px_per_m;
}

PlanView::PlanView(const Extent& extent, double px_per_m, Rgb background)
    : low_(or_square_metre(extent).low),
      px_per_m_(fitting_scale(extent, kMaxPx, px_per_m)),
      image_(pixels(or_square_metre(extent).size().x(), px_per_m_),
             pixels(or_square_metre(extent).size().y(), px_per_m_), background) {}

void PlanView::draw_grid(const Grid& grid) {
  const double cell_px = px_per_m_ * grid.cell_size_m;
  const Vector2d lower_left = to_px(grid.origin);
  std::vector<int> columns;  // for each column of the image, the column of the grid
  columns.reserve(static_cast<std::size_t>(image_.width()));
  for (int u = 0; u < image_.width(); ++u) {
    columns.push_back(static_cast<int>(std::floor((u + 0.5 - lower_left.x()) / cell_px)));
  }
  for (int v = 0; v < image_.height(); ++v) {
    const auto y = static_cast<int>(std::floor((lower_left.y() - v - 0.5) / cell_px));
    for (int u = 0; u < image_.width(); ++u) {
      const int x = columns[static_cast<std::size_t>(u)];
      if (x >= 0 && y >= 0 && x < grid.width && y < grid.height) {
        image_.set(u, v, grid.colour(x, y));
      }
    }
  }
}

void PlanView::draw_points(std::span<const Vector2d> points, double radius_px, Rgb colour) {
  for (const Vector2d& p : points) {
    const Vector2d px = to_px(p);
    image_.fill_disc(px.x(), px.y(), radius_px, colour);
  }
}

void PlanView::draw_line(const Vector2d& from, const Vector2d& to, Rgb colour, double width_px) {
  const Vector2d a = to_px(from);
  const Vector2d b = to_px(to);
  image_.draw_line(a.x(), a.y(), b.x(), b.y(), colour, width_px);
}

void PlanView::draw_path(std::span<const Vector2d> path, Rgb colour, double width_px) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    draw_line(path[i - 1], path[i], colour, width_px);
  }
}

void PlanView::fill_convex(std::span<const Vector2d> corners, Rgb colour) {
  std::vector<Vector2d> corners_px;
  Extent extent_px;
  for (const Vector2d& corner : corners) {
    corners_px.push_back(to_px(corner));
    extent_px.add(corners_px.back());
  }
  const Vector2d size_px(image_.width(), image_.height());
  const Vector2d low = extent_px.low.cwiseMax(0.0);
  const Vector2d high = extent_px.high.cwiseMin(size_px);
  for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()); ++y) {
    for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()); ++x) {
      if (is_inside(corners_px, Vector2d(x + 0.5, y + 0.5))) {
        image_.set(x, y, colour);
      }
    }
  }
  // The outline shows polygons that are thinner than a pixel.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    draw_line(corners[i], corners[(i + 1) % corners.size()], colour, 1.0);
  }
}

void PlanView::fill_disc(const Vector2d& center, double radius_m, Rgb colour) {
  constexpr double kMinRadiusPx = 1.5;
  const Vector2d px = to_px(center);
  image_.fill_disc(px.x(), px.y(), std::max(kMinRadiusPx, px_per_m_ * radius_m), colour);
}

void PlanView::draw_circle(const Vector2d& center, double radius_m, Rgb colour) {
  const Vector2d px = to_px(center);
  image_.draw_circle(px.x(), px.y(), px_per_m_ * radius_m, colour);
}

void PlanView::draw_start(const Vector2d& p, Rgb colour) {
  const Vector2d px = to_px(p);
  image_.fill_disc(px.x(), px.y(), 6.0, kWhite);
  image_.fill_disc(px.x(), px.y(), 4.0, colour);
}

void PlanView::draw_end(const Vector2d& p, Rgb colour) {
  const Vector2d px = to_px(p);
  const auto u = static_cast<int>(std::lround(px.x()));
  const auto v = static_cast<int>(std::lround(px.y()));
  image_.fill_rectangle(u - 6, v - 6, 13, 13, kWhite);
  image_.fill_rectangle(u - 4, v - 4, 9, 9, colour);
}

void PlanView::draw_scale_bar() {
  const double max_m = 0.25 * image_.width() / px_per_m_;
  const double power = std::pow(10.0, std::floor(std::log10(max_m)));
  const double length_m = power * (max_m >= 5.0 * power ? 5.0 : max_m >= 2.0 * power ? 2.0 : 1.0);
  const int bar_y = image_.height() - kMarginPx - 4;
  image_.fill_rectangle(kMarginPx, bar_y, static_cast<int>(std::lround(length_m * px_per_m_)), 4,
                        kBlack);
  std::string label = std::to_string(length_m);
  label.erase(label.find_last_not_of('0') + 1);
  if (label.back() == '.') {
    label.pop_back();
  }
  draw_text(image_, kMarginPx, bar_y - kLineHeightPx, label + " m");
}

void PlanView::draw_legend(std::span<const LegendEntry> entries) {
  constexpr int kSwatchPx = 24;
  int y = kMarginPx;
  for (const LegendEntry& entry : entries) {
    image_.fill_rectangle(kMarginPx, y + 3, kSwatchPx, 4, entry.colour);
    draw_text(image_, kMarginPx + kSwatchPx + 8, y, entry.text);
    y += kLineHeightPx;
  }
}

void draw_text(Image& image, int x, int y, const std::string& text) {
  constexpr int kDotPx = 2;
  for (const char c : text) {
    const auto capital = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const auto* glyph = std::ranges::find(kGlyphs, capital, &Glyph::character);
    for (int row = 0; glyph != kGlyphs.end() && row < kGlyphHeight; ++row) {
      const int dots = glyph->rows[static_cast<std::size_t>(row)] - '0';
      for (int column = 0; column < kGlyphWidth; ++column) {
        if ((dots >> (kGlyphWidth - 1 - column) & 1) != 0) {
          image.fill_rectangle(x + kDotPx * column, y + kDotPx * row, kDotPx, kDotPx, kBlack);
        }
      }
    }
    x += kDotPx * (kGlyphWidth + 1);
  }
}

}  // namespace nodmap::drawing
