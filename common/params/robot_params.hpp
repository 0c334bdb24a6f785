// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/robot_params.hpp"

namespace nodmap::params {

using robot::RobotParams;

}  // namespace nodmap::params
