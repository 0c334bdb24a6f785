// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/explorer/params.hpp"

namespace nodmap::explorer {

/// Remembers places that the robot could not reach, or from which it did not see what it should
/// have. Each is excluded for a time that doubles with each failure, until it is given up.
class FailedPlaces {
 public:
  explicit FailedPlaces(const PatienceParams& params) : params_(params) {}

  void add(const Eigen::Vector2d& p_map, time::Timestamp now);
  /// Whether a place near this one is excluded at present, or given up.
  [[nodiscard]] bool is_left_out(const Eigen::Vector2d& p_map, time::Timestamp now) const;
  /// Permits all excluded places that are not given up to be tried again at once; returns false if
  /// there are none.
  bool forgive();
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  void clear() { places_.clear(); }

 private:
  struct Place {
    Eigen::Vector2d p_map;
    int num_failures = 0;
    time::Timestamp until{};
  };

  PatienceParams params_;
  std::vector<Place> places_;
};

}  // namespace nodmap::explorer
