// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/time.hpp"
#include "nodmap/truth_t.hpp"
#include "sim/body/robot_model.hpp"

namespace nodmap::sim {

/// The message TRUTH without its sequence number, which the publisher sets.
[[nodiscard]] nodmap::truth_t write_truth(const GroundTruth& truth, time::Timestamp stamp);

}  // namespace nodmap::sim
