// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace nodmap::statistics {

/// The quantile by nearest rank: the smallest of the values that at least `share` (0 to 1) of all
/// do not exceed. It is always one of the values; zero if there are none.
template <class Value>
[[nodiscard]] Value quantile(std::vector<Value> values, double share) {
  if (values.empty()) {
    return Value{};
  }
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto place = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(rank), 1,
                                                static_cast<std::ptrdiff_t>(values.size())) -
                     1;
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
}

}  // namespace nodmap::statistics
