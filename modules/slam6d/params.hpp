// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/angle.hpp"
#include "modules/slam6d/odometry_prior.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/sweep_segmenter.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// Which sweeps the map keeps (IV B; the paper has 2 m).
struct KeyframeParams {
  double distance_m = 1.0;
  double rotation_rad = geometry::deg_to_rad(45.0);
  bool stationary_only = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("distance_m", distance_m, {0.0, 100.0},
             "A sweep becomes a keyframe when its base pose is farther than this from the last "
             "keyframe's.");
    v.angle("rotation_deg", rotation_rad, {0.0, 180.0},
            "A sweep becomes a keyframe when its base pose is turned by more than this.");
    v.flag("stationary_only", stationary_only,
           "Uses only sweeps during which the robot was stationary: stop, scan and go.");
  }
};

/// The occupancy map and how often it is saved and published.
struct OccupancyParams {
  double resolution_m = 0.05;
  double max_range_m = 10.0;
  int save_every_keyframes = 10;
  double publish_period_s = 5.0;
  bool save_ot = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("map_resolution_m", resolution_m, {0.01, 1.0}, "Edge of an OctoMap voxel.");
    v.number("map_max_range_m", max_range_m, {0.5, 100.0},
             "Beams enter the OctoMap up to this length.");
    v.integer("save_every_keyframes", save_every_keyframes, {0, 100000},
              "Saves the OctoMap after so many keyframes; 0: only at the end and on request.");
    v.number("octomap_period_s", publish_period_s, {0.0, 3600.0},
             "Publishes the OctoMap at most so often, after a keyframe; 0: never.");
    v.flag("save_ot", save_ot, "Saves map.ot, with probabilities, beside map.bt.");
  }
};

struct Slam6dParams {
  SweepParams sweep{};
  RangeLimits range{};
  bool assume_standing = false;
  OdometryParams odometry{};
  VoxelMapParams voxels{};
  RegistrationParams registration{};
  KeyframeParams keyframe{};
  OccupancyParams occupancy{};

  template <class Visitor>
  void describe(Visitor& v) {
    v.group("sweep", sweep);
    v.group("range", range);
    v.flag("assume_standing", assume_standing,
           "Takes the robot as standing where a recording has no odometry at all.");
    v.group("odometry", odometry);
    v.group("voxels", voxels);
    v.group("registration", registration);
    v.group("keyframe", keyframe);
    occupancy.describe(v);
  }
};

}  // namespace nodmap::slam6d
