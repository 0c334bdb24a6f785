// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/node.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "common/node/results.hpp"
#include "modules/slam6d/back_end/saved_map_file.hpp"
#include "modules/slam6d/messages.hpp"
#include "modules/slam6d/occupancy/octree_grid.hpp"
#include "modules/slam6d/results.hpp"
#include "nodmap/octomap_chunk_t.hpp"

namespace nodmap::slam6d {
namespace {

// A sweep's pose is published this many scans after the sweep's last one: 53 ms at 75 Hz, while
// registration takes some 10 ms.
constexpr int kScansUntilRegistered = 4;
// The same for a sweep with which a whole saved map is searched, which takes up to 0.5 s.
constexpr int kScansUntilFound = 60;
constexpr time::Duration kGraphPeriod = 1s;
// The occupancy map is built again when a keyframe's points have moved by more than this.
constexpr double kMinMapMotionM = 0.03;
constexpr double kMinMapMotionAtEndM = 0.005;

}  // namespace

Slam6dNode::Slam6dNode(node::Context& context, const Params& params,
                       const node::MapOptions& options)
    : context_(context),
      params_(params),
      input_(context.counts, &context.bus),
      saving_(context),
      slam_(params),
      occupancy_(params.occupancy, context.results_used),
      registering_(context.results_used) {
  if (!options.localise_in.empty() || !options.map_in.empty()) {
    restore(options);
  }
  // Enough for a second's delay on a busy machine: 75 scans and 100 odometry messages.
  constexpr int kQueue = 256;
  context.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { on_odometry(message); }, kQueue);
  context.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); }, kQueue);
  context.bus.subscribe<nodmap::save_request_t>(
      "SAVE_REQUEST", [this](const nodmap::save_request_t& message) { on_save_request(message); });
}

void Slam6dNode::restore(const node::MapOptions& options) {
  only_localises_ = !options.localise_in.empty();
  std::optional<geometry::SE3> T_map_start;
  if (options.T_map_start) {
    T_map_start = geometry::to_se3(*options.T_map_start);
  }
  slam_.restore(read_saved_map(only_localises_ ? options.localise_in : options.map_in), T_map_start,
                only_localises_);
  clouds_end_id_ = slam_.num_restored();
  log::get().info("{} {} keyframes",
                  only_localises_ ? "localises in a map of" : "continues a map of",
                  slam_.num_restored());
}

void Slam6dNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  if (input_.odometry_restarted()) {
    answer(registering_.take());
    for (const PoseUpdate& update : slam_.change_odometry_frame(*T_odom_base)) {
      publish(update);
    }
    count_scans();
  }
  slam_.add_odometry(node::stamp_of(message), *T_odom_base);
  context_.counts.use();
}

void Slam6dNode::on_scan(const nodmap::scan_t& message) {
  scan::Scan scan;
  if (!input_.read(message, scan)) {
    return;
  }
  last_stamp_ = scan.stamp;
  answer(registering_.count_message());
  answer_saved(occupancy_.count_message());
  if (saving_.is_due(last_stamp_)) {
    save_when_idle();
  }
  if (auto sweep = slam_.collect(std::move(scan))) {
    register_sweep(std::move(*sweep));
  }
  count_scans();
  publish_next_cloud();
  (void)publish_octomap_part();
}

// A LOST robot that drives registers one sweep after the other: the sweep that is being registered
// is awaited. It may begin an update of the occupancy map.
void Slam6dNode::save_when_idle() {
  if (occupancy_.is_working()) {
    return;
  }
  answer(registering_.take());
  if (!occupancy_.is_working()) {
    start_saving();
  }
}

void Slam6dNode::register_sweep(PlacedSweep sweep) {
  answer(registering_.take());
  registering_.start([this, sweep = std::move(sweep)] { return slam_.add_sweep(sweep); },
                     slam_.may_search() ? kScansUntilFound : kScansUntilRegistered);
}

void Slam6dNode::finish() {
  answer(registering_.take());
  while (const auto update = slam_.flush()) {
    publish(*update);
  }
  count_scans();
  answer_saved(occupancy_.take());
  save_unpolished();
  slam_.polish();
  if (!slam_.keyframes().empty()) {
    publish_graph(slam_.keyframes().back().cloud->stamp);
  }
  log_sweeps(slam_.metrics(), slam_.num_sweeps());
  log_mount(slam_);
  if (slam_.back_end().has_loops()) {
    log::get().info("{}", describe_loops(slam_.back_end()));
  }
  if (only_localises_) {
    return;
  }
  occupancy_.update(slam_.keyframes(), last_stamp_, kMinMapMotionAtEndM);
  const auto publish_rest = [this] {
    answer_saved(occupancy_.take());
    while (publish_octomap_part()) {
    }
  };
  publish_rest();
  occupancy_.publish_last();
  publish_rest();
}

// To polish a large map may take longer than the time that a process has to stop before it is
// killed. Until then the newest keyframes would be in memory only.
void Slam6dNode::save_unpolished() {
  if (!only_localises_ && !context_.out_dir.empty() && !slam_.keyframes().empty()) {
    answer_saved(
        save_map(context_.out_dir, occupancy_.map(), slam_.save(), params_.occupancy.save_ot));
  }
}

// The map begins where odometry is 0, as that of 2D SLAM does, so that both agree.
bool Slam6dNode::is_outside_octree(const geometry::SE3& T_map_base) const {
  const OctreeGrid grid(params_.occupancy.trace.resolution_m);
  return !(T_map_base.translation().cwiseAbs().maxCoeff() < grid.reach_m());
}

std::string Slam6dNode::describe_outside(const geometry::SE3& T_map_base) const {
  const OctreeGrid grid(params_.occupancy.trace.resolution_m);
  return fmt::format(
      "The robot is {:.1f} km from the map's origin, where odometry was 0; the OctoMap ends at "
      "{:.1f} km. Let odometry begin again at 0.",
      1e-3 * T_map_base.translation().norm(), 1e-3 * grid.reach_m());
}

// Whether a scan was used is known only when its sweep is complete.
void Slam6dNode::count_scans() {
  const ScanCounts& scans = slam_.scan_counts();
  const std::size_t without_pose = scans.without_pose - counted_.without_pose;
  const std::size_t in_sweeps = scans.in_sweeps - counted_.in_sweeps;
  const std::size_t used = in_sweeps - without_pose;
  if (in_sweeps > 0) {
    lacks_odometry_ = without_pose > 0;
  }
  for (std::size_t i = 0; i < used; ++i) {
    context_.counts.use();
  }
  for (std::size_t i = 0; i < without_pose; ++i) {
    context_.counts.reject("scan_without_odometry");
  }
  counted_ = scans;
}

void Slam6dNode::answer(const std::optional<PoseUpdate>& update) {
  if (update) {
    publish(*update);
  }
}

void Slam6dNode::publish(const PoseUpdate& update) {
  if (update.is_place_known && is_outside_octree(update.T_map_base) &&
      !std::exchange(has_warned_outside_, true)) {
    log::get().warn("{}", describe_outside(update.T_map_base));
  }
  last_update_ = update;
  context_.bus.publish("POSE_6D", write_pose(update));
  if (update.begins_anew) {
    log_mount(slam_);
    if (slam_.corrected_mount().is_zero()) {
      log::get().info("the laser is mounted as described after all; the map has begun again");
    }
    next_cloud_id_ = 0;
    clouds_end_id_ = slam_.keyframes().empty() ? 0 : slam_.keyframes().back().id + 1;
  } else if (update.keyframe) {
    publish_cloud(slam_.keyframes().back());
  }
  if (time::is_due(update.stamp, graph_stamp_, kGraphPeriod)) {
    publish_graph(update.stamp);
  }
  if (!only_localises_) {
    const auto prepare_save = [this] { return save_with_keyframes(); };
    occupancy_.update(
        slam_.keyframes(), last_stamp_, kMinMapMotionM,
        context_.out_dir.empty() ? std::function<OccupancyMapper::Save()>() : prepare_save);
  }
}

// Publishes one with each scan, so that no receiver's queue overflows.
void Slam6dNode::publish_next_cloud() {
  if (registering_.is_running()) {
    return;
  }
  const auto keyframes = slam_.keyframes();
  const auto next = std::ranges::lower_bound(keyframes, next_cloud_id_, {}, &Keyframe::id);
  if (next != keyframes.end() && next->id < clouds_end_id_) {
    publish_cloud(*next);
    next_cloud_id_ = next->id + 1;
  }
}

void Slam6dNode::publish_graph(time::Timestamp stamp) {
  if (graph_revision_ == slam_.back_end().graph_revision()) {
    return;
  }
  context_.bus.publish("POSE_GRAPH_6D", write_graph(stamp, slam_.keyframes(), slam_.back_end()));
  graph_revision_ = slam_.back_end().graph_revision();
  graph_stamp_ = stamp;
}

void Slam6dNode::publish_cloud(const Keyframe& keyframe) {
  for (const nodmap::cloud_chunk_t& chunk : write_cloud_chunks(keyframe)) {
    context_.bus.publish("CLOUD", chunk);
  }
}

void Slam6dNode::answer_saved(const std::optional<std::error_code>& error) {
  if (error) {
    saving_.record(*error, last_stamp_);
    maps_saved_ += *error ? 0 : 1;
  }
}

bool Slam6dNode::publish_octomap_part() {
  const auto part = occupancy_.next_part();
  if (!part) {
    return false;
  }
  nodmap::octomap_chunk_t message{};
  message.utime = time::to_utime(part->stamp);
  message.map_revision = part->revision;
  message.chunk_index = part->index;
  message.num_chunks = part->count;
  message.num_bytes = static_cast<std::int32_t>(part->bytes.size());
  message.bytes.assign(part->bytes.begin(), part->bytes.end());
  context_.bus.publish("OCTOMAP", message);
  return true;
}

void Slam6dNode::on_save_request(const nodmap::save_request_t& message) {
  if (only_localises_) {
    return;
  }
  answer_saved(occupancy_.take_early());  // a save that failed after the last scan
  if (saving_.accept(message, last_stamp_)) {
    answer(registering_.take());
    answer_saved(occupancy_.take_early());
    save_when_idle();
  }
}

void Slam6dNode::start_saving() {
  saving_.begin();
  occupancy_.save(save_with_keyframes());
}

OccupancyMapper::Save Slam6dNode::save_with_keyframes() const {
  return [this, keyframes = slam_.save()](const OccupancyMap& map) {
    return save_map(context_.out_dir, map, keyframes, params_.occupancy.save_ot);
  };
}

void Slam6dNode::write_results(const std::filesystem::path& dir) {
  if (slam_.localiser() && std::ranges::none_of(slam_.sweeps(), &SweepPose::is_place_known)) {
    log::get().warn("the robot was not found in the saved map");
  } else if (slam_.sweeps().empty()) {
    log::get().warn("the map is empty: no scan was used");
  } else if (slam_.keyframes().empty() && last_update_ &&
             is_outside_octree(last_update_->T_map_base)) {
    log::get().warn("the map is empty: {}", describe_outside(last_update_->T_map_base));
  } else if (slam_.keyframes().empty()) {
    log::get().warn(
        "the map is empty: none of {} sweeps has {} planes (registration.min_planes, in voxels of "
        "voxels.voxel_size_m = {} m); points nearer than range.min_m = {} m are left out",
        slam_.num_sweeps(), params_.registration.min_planes, params_.voxels.voxel_size_m,
        params_.range.min_m);
  }
  if (only_localises_) {
    write_trajectories(slam_, dir);
    return;
  }
  const auto save = [&] {
    if (const auto error =
            save_map(dir, occupancy_.map(), slam_.save(), params_.occupancy.save_ot)) {
      throw std::system_error(error, dir.string() + ": cannot save the map");
    }
    ++maps_saved_;
  };
  node::write_each({save,  // first what cannot be had again
                    [&] { write_trajectories(slam_, dir); },
                    [&] { write_cloud(slam_, params_.save_pcd, dir); }});
}

nlohmann::json Slam6dNode::metrics() const {
  registering_.wait();
  occupancy_.wait();
  nlohmann::json metrics = slam_metrics(slam_);
  metrics["loops"] = loop_metrics(slam_.back_end());
  if (slam_.localiser()) {
    metrics["localisation"] = localisation_metrics(slam_);
  }
  metrics["occupancy_map"] = {{"nodes", occupancy_.map().num_nodes()},
                              {"beams_outside", occupancy_.map().beams_outside()},
                              {"memory_bytes", occupancy_.map().memory_bytes()},
                              {"times_saved", maps_saved_}};
  return metrics;
}

node::Health Slam6dNode::health() const {
  using node::HealthState;
  if (const auto problem = saving_.problem()) {
    return *problem;
  }
  if (lacks_odometry_) {
    return {HealthState::kDegraded, "There was no odometry for some scans of the last sweep."};
  }
  if (!last_update_) {
    return {};
  }
  if (!last_update_->is_place_known) {
    return {HealthState::kDegraded, "The robot has not been found in the saved map yet."};
  }
  if (is_outside_octree(last_update_->T_map_base)) {
    return {HealthState::kDegraded, describe_outside(last_update_->T_map_base)};
  }
  if (last_update_->num_points == 0) {
    return {HealthState::kDegraded,
            "The last sweep has no point between range.min_m and range.max_m."};
  }
  if (write_pose(*last_update_).state == nodmap::pose_t::LOST) {
    return {HealthState::kDegraded, "The last sweep does not fit the map."};
  }
  return {};
}

}  // namespace nodmap::slam6d
