// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/angle.hpp"
#include "modules/slam6d/back_end/loop_closer.hpp"
#include "modules/slam6d/back_end/plane_adjustment.hpp"
#include "modules/slam6d/localise/localiser.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/occupancy/cloud_tracer.hpp"
#include "modules/slam6d/occupancy/ever_free_space.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/registration/registration.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "modules/slam6d/sweep/sweep_segmenter.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"
#include "modules/slam6d/tracking/mount_estimate.hpp"
#include "modules/slam6d/tracking/odometry_calibration.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"
#include "modules/slam6d/tracking/pitch_latency.hpp"

namespace nodmap::slam6d {

/// Which sweeps the map keeps (IV B; the paper has 2 m).
struct KeyframeParams {
  double distance_m = 1.0;
  double rotation_rad = geometry::deg_to_rad(45.0);
  bool stationary_only = false;
  int max_per_place = 6;

  /// Why a sweep becomes a keyframe that is so far from the last one; empty: it does not.
  [[nodiscard]] std::optional<KeyframeReason> reason(double moved_m, double rotated_rad) const {
    if (moved_m > distance_m) {
      return KeyframeReason::kDistance;
    }
    return rotated_rad > rotation_rad ? std::optional(KeyframeReason::kRotation) : std::nullopt;
  }

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("distance_m", distance_m, {0.0, 100.0},
             "A sweep becomes a keyframe when its base pose is farther than this from the last "
             "keyframe's.");
    v.angle("rotation_deg", rotation_rad, {0.0, 180.0},
            "A sweep becomes a keyframe when its heading differs from the last keyframe's by more "
            "than this.");
    v.flag("stationary_only", stationary_only,
           "Use only sweeps during which the robot was stationary: stop, scan and go.");
    v.integer("max_per_place", max_per_place, {0, 10000},
              "A keyframe is dropped once this many newer ones are at its place: within 0.75 m and "
              "30 degrees. All other sweeps there are dropped as well. 0: none is dropped.");
  }
};

/// The occupancy map and how often it is saved and published.
struct OccupancyParams {
  TraceParams trace{};
  int save_every_keyframes = 10;
  double publish_period_s = 5.0;
  bool save_ot = false;

  template <class Visitor>
  void describe(Visitor& v) {
    trace.describe(v);
    v.integer(
        "save_every_keyframes", save_every_keyframes, {0, 100000},
        "The map is saved each time this many keyframes were added, and a tenth of all; 0: only "
        "at the end and on request.");
    v.number("publish_period_s", publish_period_s, {0.0, 3600.0},
             "Shortest time between two publications of the OctoMap. If it has not changed it is "
             "published again after twelve times this time; 0: never published.");
    v.flag("save_ot", save_ot, "Save map.ot, with probabilities, beside map.bt.");
  }
};

struct Slam6dParams {
  SweepParams sweep{};
  RangeLimits range{};
  bool assume_stationary = false;
  OdometryParams odometry{};
  CalibrationParams calibration{};
  PitchLatencyParams pitch_latency{};
  MountParams mount{};
  VoxelMapParams voxels{};
  RegistrationParams registration{};
  KeyframeParams keyframe{};
  PathParams path{};
  LoopParams loop{};
  AdjustmentParams adjustment{};
  LocaliseParams localise{};
  EverFreeParams cloud{};
  bool save_pcd = false;
  OccupancyParams occupancy{};

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("sweep", sweep);
    v.section("range", range);
    v.flag("assume_stationary", assume_stationary,
           "Treat the robot as stationary: for recordings without odometry.");
    v.section("odometry", odometry);
    v.section("calibration", calibration);
    v.section("pitch_latency", pitch_latency);
    v.section("mount", mount);
    v.section("voxels", voxels);
    v.section("registration", registration);
    v.section("keyframe", keyframe);
    v.section("path", path);
    v.section("loop", loop);
    v.section("adjustment", adjustment);
    v.section("localise", localise);
    v.section("cloud", cloud);
    v.flag("save_pcd", save_pcd, "Save cloud.pcd beside cloud.ply.");
    v.section("occupancy", occupancy);
    describe_renamed(v);
  }

 private:
  template <class Visitor>
  static void describe_renamed(Visitor& v) {
    v.renamed("reversal_hysteresis_deg", "sweep.reversal_hysteresis_deg");
    v.renamed("jump_back_deg", "sweep.jump_back_deg");
    v.renamed("gap_s", "sweep.gap_s");
    v.renamed("max_scans", "sweep.max_scans");
    v.renamed("min_scans", "sweep.min_scans");
    v.renamed("min_range_m", "range.min_m");
    v.renamed("max_range_m", "range.max_m");
    v.renamed("assume_standing", "assume_stationary");
    v.renamed("keyframe_distance_m", "keyframe.distance_m");
    v.renamed("keyframe_rotation_deg", "keyframe.rotation_deg");
    v.renamed("standing_only", "keyframe.stationary_only");
    v.renamed("metric", "registration.metric");
    v.renamed("map_resolution_m", "occupancy.resolution_m");
    v.renamed("map_max_range_m", "occupancy.max_range_m");
    v.renamed("save_every_keyframes", "occupancy.save_every_keyframes");
    v.renamed("octomap_period_s", "occupancy.publish_period_s");
    v.renamed("save_ot", "occupancy.save_ot");
    v.renamed("calibration.least_scatter", "calibration.min_scatter");
    v.renamed("loop.max_distance_m", "loop.match.max_distance_m");
    v.renamed("loop.min_inlier_ratio", "loop.match.min_inlier_ratio");
    v.renamed("loop.max_search_m", "loop.search.max_distance_m");
    v.renamed("loop.max_search_deg", "loop.search.max_rotation_deg");
    v.renamed("loop.min_keyframes", "loop.consensus.min_keyframes");
    v.renamed("loop.max_disagreement_m", "loop.consensus.max_distance_m");
    v.renamed("loop.max_disagreement_deg", "loop.consensus.max_rotation_deg");
  }
};

/// Checks what no single parameter shows. Throws params::ParamError.
void check(const Slam6dParams& params);

}  // namespace nodmap::slam6d
