// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>

#include "common/geometry/time.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// For how long people have hidden the view, scan after scan.
class HiddenView {
 public:
  explicit HiddenView(const PeopleParams& params)
      : longest_(time::from_seconds(params.max_hidden_s)) {}

  /// They leave too little of this scan to tell its place. Returns whether to wait for them to
  /// pass: false once they have hidden the view for longer than that takes.
  [[nodiscard]] bool wait(time::Timestamp stamp) {
    since_ = since_.value_or(stamp);
    return std::chrono::abs(stamp - *since_) < longest_;
  }
  /// The place of a scan was found without waiting. Returns whether the view was hidden before.
  bool end() { return std::exchange(since_, std::nullopt).has_value(); }

 private:
  time::Duration longest_;
  std::optional<time::Timestamp> since_;  // the first scan of which they hide too much
};

}  // namespace nodmap::slam2d
