// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/chosen_arc.hpp"

#include "common/robot/stopping.hpp"

namespace nodmap::pitch_controller {
namespace {

// NAVIGATION answers a bound that is some decisions old: it rises by 1 cm/s from one to the next.
constexpr double kSameBoundMps = 0.05;

}  // namespace

NeededView needed_view(const ChosenArc& arc, double present_mps, double bound_mps,
                       const robot::Braking& braking, double processing_s) {
  NeededView view;
  if (arc.does == OnArc::kDrives && arc.max_forward_mps >= bound_mps - kSameBoundMps) {
    view.used_m = arc.free_m;
  }
  const bool is_free = arc.free_m > braking.required_distance_m(bound_mps, processing_s);
  if (arc.does == OnArc::kSlowed && is_free) {
    view.floor_from_m =
        robot::stopping_distance(present_mps, processing_s, braking.emergency_deceleration_mps2);
  }
  return view;
}

}  // namespace nodmap::pitch_controller
