// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "modules/navigator/inputs/inputs.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/reason.hpp"

namespace nodmap::navigator {

/// Why the robot must not drive on these inputs; empty if it may. Then `inputs` has odometry and an
/// obstacle map. `contested_channel`: of an input that two processes send. `limits`: those of the
/// parameters, or others.
[[nodiscard]] std::optional<Reason> inhibit_reason(
    const Inputs& inputs, const std::optional<std::string>& contested_channel,
    const NavigatorParams& params, const StalenessParams& limits);

}  // namespace nodmap::navigator
