// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// Registers the first sweep after an interruption, as register_sweep() does. Where the prior is
/// wide, the sweep also slides through the map in the direction that it determines least: along a
/// corridor. Where most points of upright planes fit is joined with the prior. If they fit over a
/// longer stretch, the covariance contains it and the state is kDegraded; if they fit as far as the
/// slide reaches, the slide says nothing.
[[nodiscard]] Registration register_sweep_sliding(VoxelMap& sweep_base, const VoxelMap& map,
                                                  const PosePrior& prior,
                                                  const RegistrationParams& params);

}  // namespace nodmap::slam6d
