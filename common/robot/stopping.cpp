// SPDX-License-Identifier: BSD-3-Clause
#include "common/robot/stopping.hpp"

#include <cmath>

namespace nodmap::robot {

double stopping_distance(double speed, double reaction_s, double deceleration) {
  return speed * reaction_s + speed * speed / (2.0 * deceleration);
}

double stoppable_speed(double distance, double reaction_s, double deceleration) {
  if (!(distance > 0.0)) {
    return 0.0;
  }
  const double lost = deceleration * reaction_s;
  return std::sqrt(lost * lost + 2.0 * deceleration * distance) - lost;
}

}  // namespace nodmap::robot
