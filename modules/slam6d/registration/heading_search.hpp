// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// Registers a sweep, starting at the pose of the prior. If too few points fit, other headings are
/// tried: wheels that spin against an obstacle count a rotation that did not take place.
[[nodiscard]] Registration register_sweep(VoxelMap& sweep_base, const VoxelMap& map,
                                          const PosePrior& prior, const RegistrationParams& params);

}  // namespace nodmap::slam6d
