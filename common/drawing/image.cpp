// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/image.hpp"

#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

#include "common/geometry/angle.hpp"

namespace nodmap::drawing {

Image::Image(int width, int height, Rgb background)
    : width_(std::max(1, width)),
      height_(std::max(1, height)),
      pixels_(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
  fill_rectangle(0, 0, width_, height_, background);
}

Rgb Image::at(int x, int y) const {
  const std::size_t offset = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(x));
  return {pixels_.at(offset), pixels_.at(offset + 1), pixels_.at(offset + 2)};
}

void Image::set(int x, int y, Rgb colour) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) {
    return;
  }
  const std::size_t offset = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(x));
  std::ranges::copy(colour, pixels_.begin() + static_cast<std::ptrdiff_t>(offset));
}

void Image::fill_rectangle(int x, int y, int width, int height, Rgb colour) {
  for (int row = std::max(0, y); row < std::min(height_, y + height); ++row) {
    for (int column = std::max(0, x); column < std::min(width_, x + width); ++column) {
      set(column, row, colour);
    }
  }
}

void Image::draw_line(double x0, double y0, double x1, double y1, Rgb colour, double width_px) {
  const double length = std::max(std::abs(x1 - x0), std::abs(y1 - y0));
  // A line to a far-away or non-finite point would take very long and show nothing.
  if (!(length < 1e5)) {
    return;
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(length)));
  for (int i = 0; i <= steps; ++i) {
    const double fraction = static_cast<double>(i) / steps;
    fill_disc(x0 + fraction * (x1 - x0), y0 + fraction * (y1 - y0), width_px / 2.0, colour);
  }
}

void Image::fill_disc(double x, double y, double radius_px, Rgb colour) {
  if (!(std::abs(x) < 1e6 && std::abs(y) < 1e6)) {
    return;
  }
  const int cx = static_cast<int>(std::lround(x));
  const int cy = static_cast<int>(std::lround(y));
  const int reach = static_cast<int>(std::floor(radius_px));
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (static_cast<double>(dx * dx + dy * dy) <= radius_px * radius_px) {
        set(cx + dx, cy + dy, colour);
      }
    }
  }
}

void Image::draw_circle(double x, double y, double radius_px, Rgb colour) {
  const int steps = std::clamp(static_cast<int>(8.0 * radius_px), 16, 20000);
  for (int i = 0; i < steps; ++i) {
    const double angle = 2.0 * geometry::kPi * i / steps;
    set(static_cast<int>(std::lround(x + radius_px * std::cos(angle))),
        static_cast<int>(std::lround(y + radius_px * std::sin(angle))), colour);
  }
}

void Image::write_png(const std::filesystem::path& file) const {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(width_);
  header.height = static_cast<png_uint_32>(height_);
  header.format = PNG_FORMAT_RGB;
  header.flags = PNG_IMAGE_FLAG_FAST;  // a process that must stop has only a second
  errno = 0;
  if (png_image_write_to_file(&header, file.c_str(), 0, pixels_.data(), 0, nullptr) == 0) {
    // Of a full disk libpng says no more than "Write Error".
    const std::string why = errno != 0 ? std::system_category().message(errno) : header.message;
    throw std::runtime_error(file.string() + ": cannot write: " + why);
  }
}

Rgb colour_scale(double value) {
  static constexpr std::array<std::array<double, 3>, 6> kStops{
      {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};
  const double place = std::clamp(std::isnan(value) ? 0.0 : value, 0.0, 1.0) * (kStops.size() - 1);
  const auto stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double fraction = place - static_cast<double>(stop);
  Rgb colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    colour.at(i) = static_cast<std::uint8_t>(std::lround(
        kStops.at(stop).at(i) + fraction * (kStops.at(stop + 1).at(i) - kStops.at(stop).at(i))));
  }
  return colour;
}

}  // namespace nodmap::drawing
