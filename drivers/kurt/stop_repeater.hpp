// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::kurt {

/// Repeats STOP once a second while the robot is stopped, for processes that start later.
class StopRepeater {
 public:
  /// The repetition that is due now, if any. `stopped_by`: empty if the robot may drive. The first
  /// one comes after one period: a sender of STOP has just published it, and a stop of the driver's
  /// own holds without the others knowing.
  [[nodiscard]] std::optional<nodmap::stop_t> repeat_if_due(
      const std::optional<std::string>& stopped_by, const time::Moment& now);

  /// Whether this is the last repetition, which the bus delivers to us as well. It may arrive after
  /// a release or a newer STOP of another sender.
  [[nodiscard]] bool is_own(const nodmap::stop_t& message) const;

 private:
  std::optional<time::SteadyTime> next_;
  std::int64_t num_repeated_ = 0;
  std::optional<nodmap::stop_t> last_;
};

}  // namespace nodmap::kurt
