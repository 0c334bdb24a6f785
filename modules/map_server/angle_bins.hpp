// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "common/geometry/angle.hpp"

namespace nodmap::map_server {

/// Maps bearings to the bins of an extended scan (III B). All bins have the same width and are
/// centred straight ahead. A full circle has N = aperture / resolution bins, as in the paper; a
/// smaller aperture has one more, because there is a bin on each of its borders.
class AngleBins {
 public:
  AngleBins(double aperture_rad, double resolution_rad) {
    const double aperture = std::clamp(aperture_rad, resolution_rad, 2.0 * geometry::kPi);
    closed_ = aperture > 2.0 * geometry::kPi - 0.5 * resolution_rad;
    const auto steps =
        static_cast<std::size_t>(std::max(1L, std::lround(aperture / resolution_rad)));
    size_ = closed_ ? steps : steps + 1;
    step_rad_ = aperture / static_cast<double>(steps);
    bins_per_rad_ = 1.0 / step_rad_;
    first_rad_ = -0.5 * aperture;
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double first_rad() const { return first_rad_; }
  [[nodiscard]] double step_rad() const { return step_rad_; }

  /// The middle of a bin.
  [[nodiscard]] double angle_rad(std::size_t bin) const {
    return first_rad_ + step_rad_ * static_cast<double>(bin);
  }

  /// The bin of a bearing in [-pi, pi]; empty outside the aperture and for NaN.
  [[nodiscard]] std::optional<std::size_t> index(double bearing_rad) const {
    // Adding a half makes the truncation round; a bearing halfway between two bins belongs to the
    // left one.
    const double place = (bearing_rad - first_rad_) * bins_per_rad_ + 0.5;
    if (!(place >= 0.0 && place < static_cast<double>(size_ + 1))) {
      return std::nullopt;
    }
    const auto bin = static_cast<std::size_t>(static_cast<int>(place));
    if (bin < size_) {
      return bin;
    }
    return closed_ ? std::optional<std::size_t>(0) : std::nullopt;
  }

 private:
  double first_rad_ = 0.0;
  double step_rad_ = 0.0;
  double bins_per_rad_ = 0.0;
  std::size_t size_ = 0;
  bool closed_ = false;  // a full circle: the last bin's neighbour is the first
};

}  // namespace nodmap::map_server
