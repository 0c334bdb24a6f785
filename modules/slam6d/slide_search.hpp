// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/registration.hpp"

namespace nodmap::slam6d {

/// Registers a sweep as register_sweep() does. Where the prior is wide, as after an interruption,
/// the sweep also slides through the map in the direction that it determines least: along a
/// corridor. The prior is narrowed to where most points of upright planes fit. If they fit over a
/// longer stretch, the covariance contains it and the state is kDegraded.
[[nodiscard]] Registration register_sweep_sliding(VoxelMap& sweep_base, const VoxelMap& map,
                                                  const PosePrior& prior,
                                                  const RegistrationParams& params);

}  // namespace nodmap::slam6d
