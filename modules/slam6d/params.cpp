// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/params.hpp"

#include "common/params/params.hpp"

namespace nodmap::slam6d {

void check(const Slam6dParams& params) {
  if (params.range.min_m >= params.range.max_m) {
    throw params::ParamError("range.min_m: is not below range.max_m");
  }
  if (params.sweep.min_scans > params.sweep.max_scans) {
    throw params::ParamError("sweep.min_scans: is above sweep.max_scans");
  }
  if (params.registration.fine_residual_scale_m > params.registration.coarse_residual_scale_m) {
    throw params::ParamError(
        "registration.fine_residual_scale_m: is above registration.coarse_residual_scale_m");
  }
  if (params.mount.min_error_rad > params.mount.max_error_rad) {
    throw params::ParamError("mount.min_error_deg: is above mount.max_error_deg");
  }
}

}  // namespace nodmap::slam6d
