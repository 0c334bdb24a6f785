// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/adjusted_sweeps.hpp"

#include <cstddef>
#include <utility>

#include "common/registration/pose_edges.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// The motion from a keyframe to a later sweep, with its covariance in the axes of map.
struct Motion {
  SE3 T_from_this = SE3::Identity();
  Matrix6d covariance = Matrix6d::Identity();
};

// `from`: a keyframe.
Motion by_odometry(const SE3& T_map_from, const PoseUpdate& from, const PoseUpdate& to,
                   const Tracker& tracker, const OdometryParams& params) {
  const SE3 T_from_to = tracker.calibration().calibrate(
      (from.T_first_odom * from.T_odom_base).inverse() * to.T_first_odom * to.T_odom_base);
  return {T_from_to,
          odometry_covariance(T_map_from,
                              {.distance_m = T_from_to.translation().norm(),
                               .rotation_rad = geometry::rotation_angle(T_from_to),
                               .is_interrupted = to.keyframe == KeyframeReason::kInterruption,
                               .scatter = tracker.odometry_scatter()},
                              params)};
}

// The mean of two motions, weighted by their information.
Motion joined(const Motion& a, const Motion& b, const SE3& T_map_from) {
  const Eigen::Matrix3d& R_map_from = T_map_from.linear();
  Vector6d a_to_b;  // axes of map
  a_to_b << R_map_from * (b.T_from_this.translation() - a.T_from_this.translation()),
      R_map_from *
          geometry::rotation_vector(b.T_from_this.linear() * a.T_from_this.linear().transpose());
  const Matrix6d information_b = registration::inverse(b.covariance);
  const Matrix6d information = registration::inverse(a.covariance) + information_b;
  Motion both{a.T_from_this, registration::inverse(information)};
  const Vector6d motion = both.covariance * information_b * a_to_b;
  both.T_from_this.translation() += R_map_from.transpose() * motion.head<3>();
  both.T_from_this.linear() =
      geometry::rotation_of(R_map_from.transpose() * motion.tail<3>()) * a.T_from_this.linear();
  return both;
}

// Collects the sweeps, to be added in order of time.
class Collection {
 public:
  Collection(const TrackedDrive& drive, const Tracker& tracker, const Slam6dParams& params)
      : drive_(drive), tracker_(tracker), params_(params) {}

  void add_keyframe(std::size_t k) {
    const Keyframe& keyframe = drive_.keyframes[k];
    AdjustedSweep& sweep = add(keyframe.sweep, keyframe.update, keyframe.T_map_base,
                               adjusted_points(keyframe.cloud->points, params_.adjustment));
    sweep.planes = keyframe.planes();
    if (k > 0 && keyframe.id == last_keyframe().id + 1) {
      add_motion(sweep, keyframe.update, drive_.steps[k - 1].T_from_to);
    } else if (k > 0) {
      add_step(sweep, drive_.steps[k - 1]);
    }
    last_ = {.keyframe = k, .place = all_.sweeps.size() - 1};
  }

  void add_between(const IntermediateSweep& between) {
    const SE3& T_map_base = drive_.poses.pose_of(between.sweep);
    AdjustedSweep& sweep = add(between.sweep, between.update, T_map_base, between.points);
    add_motion(sweep, between.update, last_keyframe().T_map_base.inverse() * T_map_base);
  }

  [[nodiscard]] AdjustedDrive take() { return std::move(all_); }

 private:
  [[nodiscard]] const Keyframe& last_keyframe() const { return drive_.keyframes[last_.keyframe]; }

  AdjustedSweep& add(std::size_t place, const PoseUpdate& update, const SE3& T_map_base,
                     std::vector<MeanPoint> points) {
    all_.places.push_back(place);
    AdjustedSweep& sweep = all_.sweeps.emplace_back(
        AdjustedSweep{.T_map_base = T_map_base, .points = std::move(points)});
    if (is_planar(update.T_odom_base)) {
      sweep.level = {.height_m = 0.0, .ground = params_.odometry.level_ground()};
    }
    return sweep;
  }

  // The motion since the last keyframe: odometry joined with the match.
  void add_motion(AdjustedSweep& sweep, const PoseUpdate& to, const SE3& T_tracked) {
    const Keyframe& from = last_keyframe();
    const Motion motion = joined(
        {T_tracked, to.covariance},
        by_odometry(from.T_map_base, from.update, to, tracker_, params_.odometry), from.T_map_base);
    sweep.from = last_.place;
    sweep.T_from_this = motion.T_from_this;
    sweep.covariance = motion.covariance;
  }

  // The same where keyframes in between were dropped: the step is the sum of all that they knew.
  void add_step(AdjustedSweep& sweep, const registration::PoseEdge3d& step) {
    sweep.from = last_.place;
    sweep.T_from_this = step.T_from_to;
    sweep.covariance = registration::rotated(registration::covariance_of(step.information),
                                             last_keyframe().T_map_base.linear());
  }

  const TrackedDrive& drive_;
  const Tracker& tracker_;
  const Slam6dParams& params_;
  AdjustedDrive all_;
  struct Last {
    std::size_t keyframe = 0;
    std::size_t place = 0;  // in all_
  } last_;
};

}  // namespace

AdjustedDrive adjusted_sweeps(const TrackedDrive& drive, const Tracker& tracker,
                              const Slam6dParams& params) {
  Collection collection(drive, tracker, params);
  std::size_t b = 0;
  for (std::size_t k = 0; k < drive.keyframes.size(); ++k) {
    for (; b < drive.between.size() && drive.between[b].sweep < drive.keyframes[k].sweep; ++b) {
      collection.add_between(drive.between[b]);
    }
    collection.add_keyframe(k);
  }
  for (; b < drive.between.size(); ++b) {
    collection.add_between(drive.between[b]);
  }
  return collection.take();
}

AdjustedPoses adjusted_poses(const TrackedDrive& drive, const Tracker& tracker,
                             const Slam6dParams& params) {
  AdjustedDrive adjusted = adjusted_sweeps(drive, tracker, params);
  const std::vector<SE3> poses = adjust_planes(std::move(adjusted.sweeps), params.voxels,
                                               params.registration, params.adjustment);
  AdjustedPoses result;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    result.sweeps.push_back({adjusted.places[i], poses[i]});
    const std::size_t k = result.T_map_keyframes.size();
    if (k < drive.keyframes.size() && drive.keyframes[k].sweep == adjusted.places[i]) {
      result.T_map_keyframes.push_back(poses[i]);
    }
  }
  return result;
}

}  // namespace nodmap::slam6d
