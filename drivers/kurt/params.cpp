// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/params.hpp"

#include "common/params/params.hpp"

namespace nodmap::kurt {

void check(const KurtParams& params) {
  if (params.device.empty()) {
    throw params::ParamError("device: is not set; name the serial port of the CAN adapter");
  }
}

}  // namespace nodmap::kurt
