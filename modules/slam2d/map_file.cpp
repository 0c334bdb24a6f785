// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/map_file.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/formats/atomic_file.hpp"

namespace nodmap::slam2d {
namespace {

// Grey values of map_server's trinary mode.
constexpr std::uint8_t kOccupiedGrey = 0;
constexpr std::uint8_t kUnknownGrey = 205;
constexpr std::uint8_t kFreeGrey = 254;

constexpr drawing::Rgb kPathColour{214, 69, 65};
constexpr drawing::Rgb kOdometryColour{170, 170, 170};
constexpr int kPathPicturePx = 1200;
constexpr double kBorderM = 1.0;

std::uint8_t grey(const OccupancyGrid& grid, int x, int y) {
  if (grid.occupancy(x, y) == OccupancyGrid::kUnknown) {
    return kUnknownGrey;
  }
  return grid.is_occupied(x, y) ? kOccupiedGrey : kFreeGrey;
}

std::string pgm_of(const OccupancyGrid& grid) {
  std::string bytes =
      "P5\n" + std::to_string(grid.width()) + " " + std::to_string(grid.height()) + "\n255\n";
  for (int y = grid.height() - 1; y >= 0; --y) {  // the first row of a picture is the top
    for (int x = 0; x < grid.width(); ++x) {
      bytes.push_back(static_cast<char>(grey(grid, x, y)));
    }
  }
  return bytes;
}

std::string yaml_of(const OccupancyGrid& grid) {
  std::ostringstream text;
  text << "image: map.pgm\n"
       << "mode: trinary\n"
       << "resolution: " << grid.cell_size_m() << "\n"
       << "origin: [" << grid.origin().x() << ", " << grid.origin().y() << ", 0]\n"
       << "negate: 0\n"
       << "occupied_thresh: 0.65\n"
       << "free_thresh: 0.196\n";
  return text.str();
}

void write(const std::filesystem::path& file, const std::string& bytes) {
  if (const auto error = formats::replace_file(file, bytes)) {
    throw std::runtime_error(file.string() + ": " + error.message());
  }
}

/// Where a place in the map lies on a picture, y up.
struct Scale {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  double px_per_m = 1.0;
  int height_px = 0;

  [[nodiscard]] Eigen::Vector2d to_px(const geometry::SE2& pose) const {
    const Eigen::Vector2d p = px_per_m * (pose.translation() - low);
    return {p.x(), height_px - p.y()};
  }
};

void draw_path(drawing::Image& image, const Scale& scale, std::span<const geometry::SE2> path,
               drawing::Rgb colour) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d from = scale.to_px(path[i - 1]);
    const Eigen::Vector2d to = scale.to_px(path[i]);
    image.draw_line(from.x(), from.y(), to.x(), to.y(), colour, 2.0);
  }
}

}  // namespace

void write_ros_map(const std::filesystem::path& dir, const OccupancyGrid& grid) {
  write(dir / "map.pgm", pgm_of(grid));
  write(dir / "map.yaml", yaml_of(grid));
}

drawing::Image draw_map(const OccupancyGrid& grid, std::span<const geometry::SE2> path) {
  drawing::Image image(std::max(1, grid.width()), std::max(1, grid.height()));
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      const std::uint8_t value = grey(grid, x, y);
      image.set(x, grid.height() - 1 - y, {value, value, value});
    }
  }
  draw_path(image, {grid.origin(), 1.0 / grid.cell_size_m(), grid.height()}, path, kPathColour);
  return image;
}

drawing::Image draw_paths(std::span<const geometry::SE2> path,
                          std::span<const geometry::SE2> odometry) {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  if (!path.empty()) {
    low = high = path.front().translation();
  }
  for (const auto poses : {path, odometry}) {
    for (const geometry::SE2& pose : poses) {
      low = low.cwiseMin(pose.translation());
      high = high.cwiseMax(pose.translation());
    }
  }
  low.array() -= kBorderM;
  high.array() += kBorderM;
  const Eigen::Vector2d size = high - low;
  const double px_per_m = kPathPicturePx / size.maxCoeff();
  const Eigen::Vector2i px = (px_per_m * size).array().ceil().cast<int>();
  drawing::Image image(px.x(), px.y());
  const Scale scale{low, px_per_m, px.y()};
  draw_path(image, scale, odometry, kOdometryColour);
  draw_path(image, scale, path, kPathColour);
  return image;
}

}  // namespace nodmap::slam2d
