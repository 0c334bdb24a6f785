// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "modules/navigator/people/detection.hpp"

namespace nodmap::navigator {

/// The legs of a person swing one against the other, so the person is in the middle of both: two
/// legs close together become one detection, the nearest two first. A single leg of few beams is
/// dropped.
[[nodiscard]] std::vector<Detection> join_legs(std::vector<Detection> detections);

}  // namespace nodmap::navigator
