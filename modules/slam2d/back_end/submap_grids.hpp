// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>

#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/matching/likelihood_grid.hpp"

namespace nodmap::slam2d {

/// The likelihood grids of the submaps that were searched last, kept because keyframe after
/// keyframe is searched for in the same few.
class SubmapGrids {
 public:
  /// Keeps at most `max_grids`, at least 1.
  explicit SubmapGrids(std::size_t max_grids) : max_grids_(max_grids) {}

  /// The grid of a submap, valid until the next call.
  [[nodiscard]] const LikelihoodGrid& of(std::size_t submap_index, const Submap& submap);

  /// Forgets all grids, because the indices of submaps have changed.
  void clear() { grids_.clear(); }

 private:
  struct Cached {
    std::size_t num_points = 0;  // of the submap, which may grow
    std::size_t last_use = 0;
    LikelihoodGrid grid;
  };

  std::size_t max_grids_;
  std::map<std::size_t, Cached> grids_;
  std::size_t uses_ = 0;
};

}  // namespace nodmap::slam2d
