// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/results.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "common/drawing/image.hpp"
#include "common/formats/ply.hpp"
#include "common/formats/tum.hpp"
#include "common/geometry/angle.hpp"
#include "modules/slam6d/cloud_picture.hpp"
#include "modules/slam6d/registered_cloud.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

const char* name_of(KeyframeReason reason) {
  switch (reason) {
    case KeyframeReason::kFirst:
      return "first";
    case KeyframeReason::kInterruption:
      return "interruption";
    case KeyframeReason::kDistance:
      return "distance";
    case KeyframeReason::kRotation:
      return "rotation";
  }
  return "";
}

const char* name_of(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kConverged:
      return "converged";
    case RegistrationStatus::kNotConverged:
      return "not_converged";
    case RegistrationStatus::kTooFewPairs:
      return "too_few_pairs";
    case RegistrationStatus::kDegenerate:
      return "degenerate";
  }
  return "";
}

nlohmann::json keyframe_figures(const SweepRecord& sweep) {
  nlohmann::json figures{
      {"utime", sweep.utime_us},   {"reason", name_of(*sweep.keyframe)},
      {"moved_m", sweep.moved_m},  {"turned_deg", geometry::rad_to_deg(sweep.turned_rad)},
      {"scans", sweep.scans_used}, {"points", sweep.num_points}};
  if (sweep.registration) {
    figures["registration"] = {{"status", name_of(sweep.registration->status)},
                               {"iterations", sweep.registration->iterations},
                               {"match_share", sweep.registration->match_share},
                               {"match_rms_m", sweep.registration->match_rms_m},
                               {"free_directions", sweep.registration->free_directions},
                               {"weakest_constraint", sweep.registration->weakest_constraint}};
  }
  return figures;
}

}  // namespace

void write_trajectories(const Slam6d& slam, const std::filesystem::path& dir) {
  const std::vector<SE3> corrected = slam.trajectory();
  formats::Trajectory trajectory;
  formats::Trajectory online;
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    const SweepRecord& sweep = slam.sweeps()[i];
    trajectory.push_back({sweep.utime_us, corrected[i]});
    online.push_back({sweep.utime_us, sweep.T_map_base});
  }
  formats::write_tum(dir / "trajectory.tum", trajectory);
  formats::write_tum(dir / "online.tum", online);
}

void write_cloud(const Slam6d& slam, const std::filesystem::path& dir) {
  const std::vector<RegisteredPoint> points = registered_cloud(slam.keyframes());
  const HeightRange heights = height_range(points);
  std::vector<formats::ColouredPoint> coloured;
  coloured.reserve(points.size());
  for (const RegisteredPoint& point : points) {
    coloured.push_back({point.p_map, drawing::colour_scale(heights.place(point.p_map.z()))});
  }
  formats::write_ply(dir / "cloud.ply", coloured);

  std::vector<Eigen::Vector3d> corrected;
  std::vector<Eigen::Vector3d> odometry;
  std::vector<Eigen::Vector3d> keyframes;
  for (const SE3& T_map_base : slam.trajectory()) {
    corrected.emplace_back(T_map_base.translation());
  }
  for (const SweepRecord& sweep : slam.sweeps()) {
    odometry.emplace_back(sweep.T_odom_base.translation());
  }
  for (const Keyframe& keyframe : slam.keyframes()) {
    keyframes.emplace_back(keyframe.T_map_base.translation());
  }
  const PicturePath path{corrected, odometry, keyframes};
  draw_map(points, path).write_png(dir / "map.png");
  draw_path(points, path).write_png(dir / "path.png");
}

nlohmann::json slam_figures(const Slam6d& slam) {
  nlohmann::json keyframes = nlohmann::json::array();
  for (const Keyframe& keyframe : slam.keyframes()) {
    keyframes.push_back(keyframe_figures(slam.sweeps()[keyframe.sweep]));
  }
  return {{"sweeps", slam.sweeps().size()},
          {"scans_in_sweeps", slam.scans_in_sweeps()},
          {"scans_without_odometry", slam.scans_without_pose()},
          {"model_points", slam.model().points().size()},
          {"keyframes", keyframes}};
}

}  // namespace nodmap::slam6d
