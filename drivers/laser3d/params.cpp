// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/params.hpp"

#include "common/params/params.hpp"

namespace nodmap::laser3d {

void check(const Laser3dParams& params) {
  if (params.nod.fallback.min_rad > params.nod.fallback.max_rad) {
    throw params::ParamError("nod.default_min_deg: is above nod.default_max_deg");
  }
  if (params.laser.range_min_m >= params.laser.range_max_m) {
    throw params::ParamError("laser.range_min_m: is not below laser.range_max_m");
  }
  if (params.servo.maestro.us_per_deg == 0.0) {
    throw params::ParamError("servo.maestro.us_per_deg: must not be 0");
  }
  constexpr int kLastMaestroChannel = 23;  // of the largest Maestro
  if (params.servo.kind == ServoKind::kMaestro && params.servo.id > kLastMaestroChannel) {
    throw params::ParamError("servo.id: the last channel of a Maestro is 23");
  }
}

void check_devices(const Laser3dParams& params) {
  if (params.laser.device.empty()) {
    throw params::ParamError("laser.device: is not set; name the serial port of the laser");
  }
  if (params.servo.device.empty()) {
    throw params::ParamError("servo.device: is not set; name the serial port of the servo");
  }
}

}  // namespace nodmap::laser3d
