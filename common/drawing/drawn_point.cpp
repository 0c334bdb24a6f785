// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/drawn_point.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/statistics/quantile.hpp"

namespace nodmap::drawing {

HeightRange height_range(std::span<const DrawnPoint> points) {
  std::vector<float> heights;
  heights.reserve(points.size());
  for (const DrawnPoint& point : points) {
    heights.push_back(point.p_map.z());
  }
  HeightRange range;
  range.low_m = statistics::quantile(heights, 0.02);
  range.high_m = std::max(statistics::quantile(std::move(heights), 0.90), range.low_m + 0.1F);
  return range;
}

}  // namespace nodmap::drawing
