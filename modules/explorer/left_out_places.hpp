// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::explorer {

/// Places that are left out for a time, which doubles with each further try, until they are given
/// up.
class LeftOutPlaces {
 public:
  /// A place is given up after `max_tries`. Places nearer to each other than `same_place_m` count
  /// as one.
  LeftOutPlaces(double pause_s, int max_tries, double same_place_m)
      : pause_s_(pause_s), max_tries_(max_tries), same_place_m_(same_place_m) {}

  /// Adds one try of a place, which has failed or was a visit.
  void add(const Eigen::Vector2d& p_map, time::Timestamp now);
  /// Whether a place near this one is left out at present, or given up.
  [[nodiscard]] bool excludes(const Eigen::Vector2d& p_map, time::Timestamp now) const;
  /// Permits all places that are not given up at once; returns false if there are none.
  bool permit_retries();
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] std::size_t num_given_up() const;
  void clear() { places_.clear(); }

 private:
  struct Place {
    Eigen::Vector2d p_map;
    int num_tries = 0;
    time::Timestamp since{};
    time::Duration pause{};  ///< 0: it is permitted at once
  };

  double pause_s_;
  int max_tries_;
  double same_place_m_;
  std::vector<Place> places_;
};

}  // namespace nodmap::explorer
