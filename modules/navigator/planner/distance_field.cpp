// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::navigator {
namespace {

constexpr float kNone = 1e12F;

}  // namespace

void DistanceField::begin(const Eigen::Vector2d& origin, double cell_size_m, int width,
                          int height) {
  origin_ = origin;
  cell_size_m_ = cell_size_m;
  cells_per_m_ = 1.0 / cell_size_m;
  width_ = width;
  height_ = height;
  num_lines_ = 0;
  squared_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kNone);
  distance_m_.resize(squared_.size());
  const auto longest = static_cast<std::size_t>(std::max(width, height));
  values_.resize(longest);
  vertices_.resize(longest);
  borders_.resize(longest + 1);
}

void DistanceField::occupy(const Eigen::Vector2d& p) {
  const auto column = static_cast<int>(std::floor((p.x() - origin_.x()) * cells_per_m_));
  const auto row = static_cast<int>(std::floor((p.y() - origin_.y()) * cells_per_m_));
  if (column >= 0 && row >= 0 && column < width_ && row < height_) {
    occupy(column, row);
  }
}

bool DistanceField::compute_line() {
  const int line = num_lines_;
  num_lines_ = (line + 1) % (2 * height_ + width_);
  if (line < height_) {
    transform(&squared_[index_of(0, line)], 1, width_);
  } else if (line < height_ + width_) {
    transform(&squared_[index_of(line - height_, 0)], width_, height_);
  } else {
    take_root(line - height_ - width_);
  }
  return num_lines_ > 0;
}

void DistanceField::take_root(int row) {
  const auto first = static_cast<std::ptrdiff_t>(index_of(0, row));
  const auto squared = squared_.begin() + first;
  std::transform(squared, squared + width_, distance_m_.begin() + first, [this](float value) {
    return value >= kNone ? static_cast<float>(kFarM)
                          : static_cast<float>(cell_size_m_) * std::sqrt(value);
  });
}

// Transforms one line: sets line[i] to the least of (i - j)^2 + line[j] over all j.
void DistanceField::transform(float* line, int stride, int n) {
  int last = -1;  // index of the last parabola of the envelope
  for (int i = 0; i < n; ++i) {
    const float value = line[static_cast<std::ptrdiff_t>(i) * stride];
    values_[static_cast<std::size_t>(i)] = value;
    if (value >= kNone) {
      continue;
    }
    float border = -std::numeric_limits<float>::infinity();
    while (last >= 0) {
      const int j = vertices_[static_cast<std::size_t>(last)];
      border = (value - values_[static_cast<std::size_t>(j)] + static_cast<float>(i * i - j * j)) /
               static_cast<float>(2 * (i - j));
      if (border > borders_[static_cast<std::size_t>(last)]) {
        break;
      }
      --last;
    }
    ++last;
    vertices_[static_cast<std::size_t>(last)] = i;
    borders_[static_cast<std::size_t>(last)] =
        last == 0 ? -std::numeric_limits<float>::infinity() : border;
  }
  if (last < 0) {
    return;
  }
  int k = 0;
  for (int i = 0; i < n; ++i) {
    while (k < last && borders_[static_cast<std::size_t>(k + 1)] < static_cast<float>(i)) {
      ++k;
    }
    const int j = vertices_[static_cast<std::size_t>(k)];
    line[static_cast<std::ptrdiff_t>(i) * stride] =
        static_cast<float>((i - j) * (i - j)) + values_[static_cast<std::size_t>(j)];
  }
}

}  // namespace nodmap::navigator
