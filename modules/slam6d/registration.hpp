// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/surface.hpp"

namespace nodmap::slam6d {

struct RegistrationOptions {
  Metric metric = Metric::kPlanes;
  double max_correspondence_m = 1.0;   ///< gate of the first iteration
  double min_correspondence_m = 0.25;  ///< gate of the last ones
  double residual_scale_m = 0.03;      ///< kPlanes: distance at which a pair counts half
  double min_constraint = 0.003;       ///< kPlanes: below, a direction counts as free
  double min_match_share = 0.15;
  int iterations = 60;
  double ground_weight = 0.0;  ///< kPlanes: of the ground plane, relative to all pairs together
};

enum class RegistrationStatus {
  kConverged,
  kNotConverged,  ///< still moving after the last iteration; the pose is the last one
  kTooFewPairs,   ///< hardly anything in common with the model; the pose is the guess
  kDegenerate     ///< the pairs determine no motion; the pose is the guess
};

struct Registration {
  RegistrationStatus status = RegistrationStatus::kTooFewPairs;
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  int iterations = 0;
  double match_share = 0.0;  ///< points with a partner within the last gate, of all points
  double match_rms_m = 0.0;  ///< of the distances that were made small
  int free_directions = 0;   ///< of six: those that the scene leaves open and that kept the guess
  /// How well the scene's planes hold the weakest direction: mean squared cosine, 0 not at all,
  /// 1/3 a cube's sides; 1 for kPaper, whose pairs hold every direction.
  double weakest_constraint = 1.0;

  [[nodiscard]] bool is_usable() const {
    return status == RegistrationStatus::kConverged || status == RegistrationStatus::kNotConverged;
  }
};

/// The Iterative Closest Point algorithm: finds the pose of a surface (in base) in the model,
/// starting from `T_map_base_guess`. The gate for pairs closes from iteration to iteration.
///
/// kPaper minimises Eq. 3 in closed form. It pairs points with points, and so has two known
/// weaknesses on a nodding scanner's clouds: the scan lines of the two clouds attract each other
/// along the surfaces, and a corridor pulls the new cloud back onto the part already seen.
///
/// kPlanes replaces m_i in Eq. 3 by the foot of d_j on the plane about m_i: sliding along a surface
/// costs nothing. Eq. 3 repeated with renewed feet leads to the smallest sum of squared distances
/// from points to planes, but in steps that shrink with the share of planes that hold a direction;
/// here each iteration goes to that minimum at once (one Gauss-Newton step, Chen and Medioni 1992).
/// The step is left out along directions that (almost) no plane holds: they keep the guess, which
/// is the odometry (Zhang, Kaess, Singh 2016).
[[nodiscard]] Registration register_surface(const Surface& surface_base, const Model& model,
                                            const geometry::SE3& T_map_base_guess,
                                            const RegistrationOptions& options);

}  // namespace nodmap::slam6d
