// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/drawn_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::drawing {

HeightRange height_range(std::span<const DrawnPoint> points) {
  std::vector<float> heights;
  heights.reserve(points.size());
  for (const DrawnPoint& point : points) {
    heights.push_back(point.p_map.z());
  }
  HeightRange range;
  range.low_m = quantile(heights, 0.02);
  range.high_m = std::max(quantile(std::move(heights), 0.90), range.low_m + 0.1F);
  return range;
}

float quantile(std::vector<float> values, double share) {
  if (values.empty()) {
    return 0.0F;
  }
  const auto place = std::lround(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
}

}  // namespace nodmap::drawing
