// SPDX-License-Identifier: BSD-3-Clause
// The messages that a sheriff publishes: orders to its deputies, and that it begins or ends.
#pragma once

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "procman/protocol/fleet.hpp"

namespace nodmap::procman {

/// A sheriff repeats its orders this often, for deputies that have missed them.
inline constexpr time::Duration kOrdersPeriod = 1s;

/// Publishes the orders for each deputy that has reported.
void publish_orders(bus::Bus& bus, const Fleet& fleet, time::Timestamp stamp);

/// Publishes that the sheriff of a fleet begins, so that the deputies report at once; or that it
/// ends, so that they obey the next sheriff at once.
void publish_discovery(bus::Bus& bus, const Fleet& fleet, time::Timestamp stamp);

}  // namespace nodmap::procman
