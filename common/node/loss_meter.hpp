// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"

namespace nodmap::node {

/// Measures which share of a device's scans or frames is lost, once a second: as often as STATUS is
/// sent, and over enough of them (75 scans, 100 encoder frames) that a few do not matter.
class LossMeter {
 public:
  /// Takes the numbers since the start. To be called often.
  void take(std::int64_t lost, std::int64_t delivered, time::SteadyTime now) {
    since_ = since_.value_or(now);
    if (now - *since_ < std::chrono::seconds(1)) {
      return;
    }
    const auto all = static_cast<double>(lost - lost_ + delivered - delivered_);
    ratio_ = all > 0.0 ? static_cast<double>(lost - lost_) / all : 0.0;
    since_ = now;
    lost_ = lost;
    delivered_ = delivered;
  }

  /// A tenth: more than single damaged bytes or a pause of 0.1 s cost, so the line is bad.
  [[nodiscard]] bool loses_many() const { return ratio_ > 0.1; }

 private:
  std::optional<time::SteadyTime> since_;
  std::int64_t lost_ = 0;  // at that time
  std::int64_t delivered_ = 0;
  double ratio_ = 0.0;
};

}  // namespace nodmap::node
