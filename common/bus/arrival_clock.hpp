// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>

#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Tells by the steady clock when datagrams were received, from the kernel's stamps by the wall
/// clock. A process that was frozen reads all that waited at one moment; were they dated then,
/// every sender would seem to have been silent until then.
///
/// If the wall clock is set while datagrams wait, some are dated wrongly, but never before the
/// socket was last empty, never after they are read, and never before an earlier one.
class ArrivalClock {
 public:
  /// The socket is empty at `now`.
  explicit ArrivalClock(time::SteadyTime now) : latest_(now) {}

  /// To be called before datagrams are read.
  void begin(const time::Moment& now) { now_ = now; }

  /// When a datagram that has been read was received; in the order in which they were received.
  [[nodiscard]] time::SteadyTime arrival(time::Timestamp received) {
    const time::Duration waited = std::max<time::Duration>(now_.wall - received, 0us);
    latest_ = std::max(latest_, now_.steady - waited);
    return latest_;
  }

  /// To be called when datagrams were read and no other waited: all others come later.
  void drained() { latest_ = std::max(latest_, now_.steady); }

 private:
  time::Moment now_;
  time::SteadyTime latest_;  // no datagram that is still to be read was received before
};

}  // namespace nodmap::bus
