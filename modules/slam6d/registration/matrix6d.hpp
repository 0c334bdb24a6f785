// SPDX-License-Identifier: BSD-3-Clause
// Vectors and matrices of the six directions of a pose: position (m) and rotation vector (rad).
#pragma once

#include "common/registration/dense_solvers.hpp"

namespace nodmap::slam6d {

using registration::Matrix6d;
using registration::Vector6d;

}  // namespace nodmap::slam6d
