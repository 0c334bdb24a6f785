// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/bytes.hpp"

namespace nodmap::sim {

/// What a receiver at `heard_baud` makes of bytes sent back to back at `sent_baud`, 8N1: it waits
/// for a falling edge and then samples in the middle of its own bits. A byte without stop bit comes
/// as zero, as Linux gives it. Rates that differ by up to 4 % do no harm.
[[nodiscard]] Bytes heard_at(int heard_baud, ByteView bytes, int sent_baud);

}  // namespace nodmap::sim
