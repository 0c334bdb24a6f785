// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/results.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/drawing/cloud_view.hpp"
#include "common/drawing/image.hpp"
#include "common/formats/atomic_file.hpp"
#include "common/formats/cloud_file.hpp"
#include "common/formats/tum.hpp"
#include "common/geometry/angle.hpp"
#include "common/node/log.hpp"
#include "common/node/results.hpp"
#include "common/registration/dense_solvers.hpp"
#include "modules/slam6d/back_end/saved_map_file.hpp"
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

const char* name_of(PoseState state) {
  switch (state) {
    case PoseState::kTracking:
      return "tracking";
    case PoseState::kDegraded:
      return "degraded";
    case PoseState::kLost:
      return "lost";
  }
  return "";
}

nlohmann::json keyframe_metrics(const PoseUpdate& update) {
  nlohmann::json metrics{{"utime", time::to_utime(update.stamp)},
                         {"reason", name_of(*update.keyframe)},
                         {"distance_m", update.distance_m},
                         {"rotation_deg", geometry::rad_to_deg(update.rotation_rad)},
                         {"scans", update.scans_used},
                         {"points", update.num_points}};
  if (update.registration) {
    metrics["registration"] = {
        {"status", name_of(update.registration->state)},
        {"iterations", update.registration->iterations},
        {"inlier_ratio", update.registration->inlier_ratio},
        {"residual_rms_m", update.registration->residual_rms_m},
        {"prior_distance", update.registration->prior_distance},
        {"degenerate_directions", update.registration->degenerate_directions},
        {"sigma_m", std::sqrt(update.covariance.topLeftCorner<3, 3>().trace())},
        {"sigma_deg",
         geometry::rad_to_deg(std::sqrt(update.covariance.bottomRightCorner<3, 3>().trace()))}};
  }
  return metrics;
}

// More would cover each other in an image of 1.5 to 2.7 million pixels. They take 48 MB.
constexpr std::size_t kMaxDrawnPoints = 2'000'000;

// Loops of successive keyframes with one stretch of the way.
struct LoopRun {
  registration::PoseEdge3d first;
  registration::PoseEdge3d last;
};

std::vector<LoopRun> runs_of(std::span<const KeyframeGraph::WeightedLoop> loops) {
  constexpr std::size_t kGap = 5;  // keyframes
  const auto is_near = [](std::size_t a, std::size_t b) {
    return std::max(a, b) - std::min(a, b) <= kGap;
  };
  std::vector<LoopRun> runs;
  for (const KeyframeGraph::WeightedLoop& loop : loops) {
    if (loop.is_contradicted()) {
      continue;
    }
    const auto run = std::ranges::find_if(runs, [&](const LoopRun& one) {
      return is_near(one.last.to, loop.edge.to) && is_near(one.last.from, loop.edge.from);
    });
    if (run == runs.end()) {
      runs.push_back({loop.edge, loop.edge});
    } else {
      run->last = loop.edge;
    }
  }
  return runs;
}

// The standard deviation of a keyframe's position along its most uncertain direction, metres; NaN
// for a keyframe of a saved map, of which it is not known.
float position_sigma_m(const Keyframe& keyframe) {
  if (!keyframe.update.keyframe) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  const Eigen::Matrix3d covariance = keyframe.update.covariance.topLeftCorner<3, 3>();
  return static_cast<float>(std::sqrt(registration::eigensystem(covariance).values[2]));
}

// Keyframe by keyframe: a large cloud would be in memory several times.
void write_coloured(std::span<const Keyframe> keyframes, const drawing::HeightRange& heights,
                    const std::filesystem::path& file, formats::CloudFormat format) {
  formats::CloudWriter writer(file, format, num_registered(keyframes));
  std::vector<formats::CloudPoint> coloured;
  for (const Keyframe& keyframe : keyframes) {
    coloured.clear();
    const double time_s = time::seconds(keyframe.cloud->stamp.time_since_epoch());
    const float sigma_m = position_sigma_m(keyframe);
    for (const Eigen::Vector3f& p_map : registered_points(keyframe)) {
      coloured.push_back({p_map, drawing::colour_scale(heights.place(p_map.z())), time_s, sigma_m});
    }
    writer.write(coloured);
  }
  writer.finish();
}

nlohmann::json mount_metrics(const Slam6d& slam) {
  const auto degrees = [](const MountError& error) {
    return nlohmann::json{{"pitch_deg", geometry::rad_to_deg(error.pitch_rad)},
                          {"roll_deg", geometry::rad_to_deg(error.roll_rad)}};
  };
  return {{"floors", slam.mount().num_sweeps()},
          {"learned", degrees(slam.mount().median())},
          {"sigma", degrees(slam.mount().sigma())},
          {"corrected", degrees(slam.corrected_mount())}};
}

}  // namespace

void write_trajectories(const Slam6d& slam, const std::filesystem::path& dir) {
  const std::vector<SE3> corrected = slam.trajectory();
  formats::Trajectory trajectory;
  formats::Trajectory online;
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    const SweepPose& sweep = slam.sweeps()[i];
    if (!sweep.is_place_known) {
      continue;
    }
    trajectory.push_back({sweep.stamp, corrected[i]});
    online.push_back({sweep.stamp, sweep.T_map_base_online});
  }
  node::write_each({[&] { formats::write_tum(dir / "trajectory.tum", trajectory); },
                    [&] { formats::write_tum(dir / "online.tum", online); }});
}

DrivenPath driven_path(const Slam6d& slam) {
  const std::vector<SE3> corrected = slam.trajectory();
  DrivenPath path;
  SE3 T_map_first_odom = SE3::Identity();
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    const SweepPose& sweep = slam.sweeps()[i];
    if (!sweep.is_place_known) {
      continue;
    }
    if (path.odometry.empty()) {
      T_map_first_odom = corrected[i] * sweep.T_first_base.inverse();
    }
    path.corrected.emplace_back(corrected[i].translation());
    path.odometry.emplace_back(T_map_first_odom * sweep.T_first_base.translation());
  }
  return path;
}

void write_cloud(const Slam6d& slam, bool with_pcd, const std::filesystem::path& dir) {
  const std::vector<drawing::DrawnPoint> points = drawn_cloud(slam.keyframes(), kMaxDrawnPoints);
  const drawing::HeightRange heights = drawing::height_range(points);
  using Format = formats::CloudFormat;
  write_coloured(slam.keyframes(), heights, dir / "cloud.ply", Format::kPly);
  if (with_pcd) {
    write_coloured(slam.keyframes(), heights, dir / "cloud.pcd", Format::kPcd);
  }

  const DrivenPath driven = driven_path(slam);
  std::vector<Eigen::Vector3d> keyframes;
  for (const Keyframe& keyframe : slam.keyframes()) {
    keyframes.emplace_back(keyframe.T_map_base.translation());
  }
  const drawing::DrawnPath path{driven.corrected, driven.odometry, keyframes};
  drawing::draw_cloud(points, path).write_png(dir / "map.png");
  drawing::draw_path_on_cloud(points, path).write_png(dir / "path.png");
}

std::error_code save_map(const std::filesystem::path& dir, const OccupancyMap& map,
                         const SavedMap& keyframes, bool with_ot) {
  // First what cannot be made again: if the disk fills up in between, the other files are older.
  if (!keyframes.keyframes.empty()) {
    if (const auto error = write_saved_map(dir, keyframes)) {
      return error;
    }
  }
  using Format = OccupancyMap::Format;
  std::vector<std::pair<Format, const char*>> files{{Format::kBt, "map.bt"}};
  if (with_ot) {
    files.emplace_back(Format::kOt, "map.ot");
  }
  for (const auto& [format, name] : files) {
    const auto bytes = map.encode(format);
    if (!bytes) {
      return std::make_error_code(std::errc::io_error);
    }
    if (const auto error = formats::replace_file(dir / name, *bytes)) {
      return error;
    }
  }
  return {};
}

nlohmann::json loop_metrics(const BackEnd& back_end) {
  const BackEndMetrics& metrics = back_end.metrics();
  return {{"tracked", metrics.loops_tracked},
          {"searched", metrics.loops_searched},
          {"searches", metrics.searches},
          {"refused_ambiguous", metrics.refused_ambiguous},
          {"refused_match", metrics.refused_match},
          {"refused_by_graph", back_end.graph().num_contradicted()},
          {"corrections", metrics.corrections},
          {"largest_correction_m", metrics.largest_correction_m},
          {"maps_arranged", metrics.maps_arranged}};
}

std::string describe_loops(const BackEnd& back_end) {
  const BackEndMetrics& metrics = back_end.metrics();
  std::ostringstream text;
  text << metrics.loops_tracked << " loops closed by a match, " << metrics.loops_searched << " by "
       << metrics.searches << " searches; refused: " << metrics.refused_match << " fitted poorly, "
       << metrics.refused_ambiguous << " fitted several places; "
       << back_end.graph().num_contradicted()
       << " contradict the graph; keyframes at places of before: ";
  const char* separator = "";
  for (const LoopRun& run : runs_of(back_end.graph().loops())) {
    text << separator << run.first.to << ".." << run.last.to << " at " << run.first.from << ".."
         << run.last.from;
    separator = ", ";
  }
  return text.str();
}

nlohmann::json localisation_metrics(const Slam6d& slam) {
  const Localiser::Metrics& metrics = slam.localiser()->metrics();
  return {{"keyframes_restored", slam.num_restored()},
          {"searches", metrics.searches},
          {"searches_found", metrics.found},
          {"times_lost", metrics.times_lost},
          {"times_contradicted", metrics.times_contradicted}};
}

void log_mount(const Slam6d& slam) {
  // The steps of a Dynamixel, 4096 in a revolution.
  constexpr double kStepDeg = 360.0 / 4096.0;
  const MountError& error = slam.mount().believed();
  if (error.is_zero()) {
    return;
  }
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  if (const double pitch_deg = geometry::rad_to_deg(error.pitch_rad); pitch_deg != 0.0) {
    const auto steps = std::lround(-pitch_deg / kStepDeg);
    text << " looks " << std::abs(pitch_deg) << " degrees "
         << (pitch_deg > 0.0 ? "higher" : "lower") << " than its pitch says: add " << steps
         << " to servo.dynamixel.level_position, or change the level of another servo as much;";
  }
  if (const double roll_deg = geometry::rad_to_deg(error.roll_rad); roll_deg != 0.0) {
    text << " is rolled on its head by " << std::abs(roll_deg) << " degrees, its "
         << (roll_deg > 0.0 ? "left" : "right") << " side higher: turn it back;";
  }
  log::get().warn("the floor around the robot shows that the laser{} {} in this map", text.str(),
                  slam.corrected_mount().is_zero() ? "not corrected" : "corrected");
}

void log_sweeps(const Metrics& metrics, std::size_t num_sweeps) {
  const bool is_mostly_lost = 2 * (metrics.sweeps_lost + metrics.sweeps_unused) > num_sweeps;
  log::get().log(is_mostly_lost ? spdlog::level::warn : spdlog::level::info,
                 "sweeps: {} tracked, {} degraded, {} lost, {} not registered of {}",
                 metrics.sweeps_tracked, metrics.sweeps_degraded, metrics.sweeps_lost,
                 metrics.sweeps_unused, num_sweeps);
}

nlohmann::json slam_metrics(const Slam6d& slam) {
  nlohmann::json keyframes = nlohmann::json::array();
  for (const Keyframe& keyframe : slam.keyframes().subspan(slam.num_restored())) {
    keyframes.push_back(keyframe_metrics(keyframe.update));
  }
  const Metrics metrics = slam.metrics();
  return {{"sweeps", slam.num_sweeps()},
          {"sweeps_tracked", metrics.sweeps_tracked},
          {"sweeps_degraded", metrics.sweeps_degraded},
          {"sweeps_lost", metrics.sweeps_lost},
          {"sweeps_unused", metrics.sweeps_unused},
          {"scans_in_sweeps", slam.scan_counts().in_sweeps},
          {"scans_without_odometry", slam.scan_counts().without_pose},
          {"odometry_errors",
           {{"per_m", slam.calibration().errors()[0]},
            {"per_rad", slam.calibration().errors()[1]},
            {"yaw_per_m_deg", geometry::rad_to_deg(slam.calibration().errors()[2])}}},
          {"pitch_latency_s", slam.pitch_latency_s()},
          {"mount_errors", mount_metrics(slam)},
          {"map_voxels", metrics.map_voxels},
          {"map_memory_bytes", metrics.map_memory_bytes},
          {"keyframe_memory_bytes", metrics.keyframe_memory_bytes},
          {"keyframes_dropped", slam.back_end().metrics().keyframes_dropped},
          {"keyframes", keyframes}};
}

}  // namespace nodmap::slam6d
