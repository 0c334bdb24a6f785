// SPDX-License-Identifier: BSD-3-Clause
// Messages of the package procman_lcm to values and back. Every message that decodes encodes to the
// same bytes again.
#pragma once

#include "procman/protocol/values.hpp"
#include "procman_lcm/deputy_info_t.hpp"
#include "procman_lcm/discovery_t.hpp"
#include "procman_lcm/orders_t.hpp"
#include "procman_lcm/output_t.hpp"

namespace nodmap::procman {

[[nodiscard]] Discovery from_message(const procman_lcm::discovery_t& message);
[[nodiscard]] DeputyInfo from_message(const procman_lcm::deputy_info_t& message);
[[nodiscard]] Orders from_message(const procman_lcm::orders_t& message);
[[nodiscard]] Output from_message(const procman_lcm::output_t& message);
/// Of PM_RUNS: for each command a text "PID UPTIME_US RESTARTS"; what is none is left out.
[[nodiscard]] Runs runs_from_message(const procman_lcm::output_t& message);

[[nodiscard]] procman_lcm::discovery_t to_message(const Discovery& discovery);
[[nodiscard]] procman_lcm::deputy_info_t to_message(const DeputyInfo& info);
[[nodiscard]] procman_lcm::orders_t to_message(const Orders& orders);
[[nodiscard]] procman_lcm::output_t to_message(const Output& output);
[[nodiscard]] procman_lcm::output_t to_message(const Runs& runs);

}  // namespace nodmap::procman
