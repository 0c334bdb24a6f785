// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/clock.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::test {

/// A clock that shows the time that a test sets.
class ManualClock : public time::Clock {
 public:
  explicit ManualClock(time::Timestamp now) : now_(now) {}
  [[nodiscard]] time::Timestamp now() const override { return now_; }
  void set(time::Timestamp now) { now_ = now; }
  void advance(time::Duration duration) { now_ += duration; }

 private:
  time::Timestamp now_;
};

}  // namespace nodmap::test
