// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/sheriff_messages.hpp"

#include "procman/protocol/messages.hpp"

namespace nodmap::procman {

void publish_orders(bus::Bus& bus, const Fleet& fleet, time::Timestamp stamp) {
  for (const auto& [deputy, report] : fleet.deputies().all()) {
    if (const auto orders = fleet.orders_for(deputy, stamp)) {
      bus.publish(kOrdersChannel, to_message(*orders));
    }
  }
}

void publish_discovery(bus::Bus& bus, const Fleet& fleet, time::Timestamp stamp) {
  bus.publish(kDiscoverChannel, to_message(Discovery{stamp, fleet.sheriff_id(), 0}));
}

}  // namespace nodmap::procman
