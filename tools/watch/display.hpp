// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <ostream>

#include "common/geometry/time.hpp"
#include "tools/watch/overview.hpp"

namespace nodmap::watch {

/// Redraws one line on a terminal. Elsewhere writes a line every five seconds, the first so long
/// after the first scan: before, there is nothing to show.
class Display {
 public:
  Display(std::ostream& out, bool is_terminal);

  void show(const Overview& overview, time::SteadyTime now);

  /// Shows the last state and ends the line. Elsewhere than on a terminal writes nothing if no scan
  /// has come.
  void end(const Overview& overview, time::SteadyTime now);

 private:
  void write(const Overview& overview, time::SteadyTime now);

  std::ostream& out_;
  bool is_terminal_;
  std::optional<time::SteadyTime> next_;  // empty until the first scan
};

}  // namespace nodmap::watch
