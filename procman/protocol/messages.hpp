// SPDX-License-Identifier: BSD-3-Clause
// Converts the messages of package procman_lcm, and our PM_RUNS, to values and back. A valid
// message of procman_lcm that is converted to values and back has the same bytes again.
#pragma once

#include "nodmap/runs_t.hpp"
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
/// Omits invalid runs (without a process, or with a negative number).
[[nodiscard]] Runs from_message(const nodmap::runs_t& message);

[[nodiscard]] procman_lcm::discovery_t to_message(const Discovery& discovery);
[[nodiscard]] procman_lcm::deputy_info_t to_message(const DeputyInfo& info);
[[nodiscard]] procman_lcm::orders_t to_message(const Orders& orders);
[[nodiscard]] procman_lcm::output_t to_message(const Output& output);
[[nodiscard]] nodmap::runs_t to_message(const Runs& runs);

}  // namespace nodmap::procman
