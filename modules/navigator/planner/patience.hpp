// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"

namespace nodmap::navigator {

/// Longest time between two decisions of one behaviour. After a longer pause, because the robot was
/// stopped or another behaviour decided, the time without progress counts anew.
inline constexpr time::Duration kLongestPeriod = 200ms;

/// Measures for how long a behaviour has decided without progress. The behaviour says what progress
/// is; for driving along a path PathProgress says it.
class Patience {
 public:
  /// `lasts`: the time without progress after which patience is over.
  explicit Patience(time::Duration lasts) : lasts_(lasts) {}

  /// The behaviour decides; ends the measurement after a pause.
  void record(time::Timestamp stamp) {
    if (decided_at_ && std::chrono::abs(stamp - *decided_at_) > kLongestPeriod) {
      end();
    }
    decided_at_ = stamp;
  }

  /// Begins to wait anew, because there was progress.
  void restart(time::Timestamp stamp) { began_at_ = stamp; }
  void end() { began_at_.reset(); }

  [[nodiscard]] bool has_begun() const { return began_at_.has_value(); }
  [[nodiscard]] bool is_over(time::Timestamp stamp) const {
    return began_at_ && std::chrono::abs(stamp - *began_at_) >= lasts_;
  }

 private:
  time::Duration lasts_;
  std::optional<time::Timestamp> began_at_;
  std::optional<time::Timestamp> decided_at_;
};

}  // namespace nodmap::navigator
