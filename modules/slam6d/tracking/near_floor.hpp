// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modules/slam6d/sweep/mount_error.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// The error of the laser's mount by which the floor right around the robot would be the plane
/// z = 0 of base, as it is for wheels that stand on it, whatever the slope. One sweep tells it no
/// better than the ground is even.
///
/// Empty if the sweep sees too little floor, or too much else near it.
[[nodiscard]] std::optional<MountError> mount_error_by_floor(const PlacedSweep& sweep);

}  // namespace nodmap::slam6d
