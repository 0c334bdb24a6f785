// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "modules/map_server/extended_scan.hpp"
#include "modules/map_server/update_rule.hpp"

namespace nodmap::map_server {

/// A 2D obstacle map or structure map (paper, III A): an extended scan, and the rule that removes
/// and replaces points.
class EgoMap {
 public:
  EgoMap(ExtendedScan scan, std::unique_ptr<UpdateRule> rule)
      : scan_(std::move(scan)), rule_(std::move(rule)) {}

  /// Runs the three steps of III B, in the paper's order, for one scan. `T_now_last` transforms
  /// points from the base frame of the last update to the present one; empty if the robot has not
  /// moved. Then step 1 is skipped, and step 2 unless the rule also removes while stationary.
  void update(const std::optional<geometry::SE2>& T_now_last, const NewScan& scan) {
    if (T_now_last) {
      scan_.transform(*T_now_last);  // 1) transformation
    }
    if (T_now_last || rule_->removes_while_stationary()) {
      removed_ += rule_->remove_obsolete(scan_, scan);  // 2) removing obsolete points
    }
    rule_->replace(scan_, scan);  // 3) point replacement
  }

  void clear() { scan_.clear(); }

  [[nodiscard]] const ExtendedScan& scan() const { return scan_; }

  /// Number of points that step 2 has removed since the start.
  [[nodiscard]] std::size_t removed() const { return removed_; }

 private:
  ExtendedScan scan_;
  std::unique_ptr<UpdateRule> rule_;
  std::size_t removed_ = 0;
};

/// A map of the nearest point in each direction within the heights of the virtual corridor.
[[nodiscard]] EgoMap make_obstacle_map(const MapServerParams& params);

/// A map of the farthest point in each direction above the floor.
[[nodiscard]] EgoMap make_structure_map(const MapServerParams& params);

}  // namespace nodmap::map_server
