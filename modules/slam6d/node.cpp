// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/node.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/formats/atomic_file.hpp"
#include "common/node/log.hpp"
#include "common/node/message_input.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/results.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/octomap_chunk_t.hpp"
#include "nodmap/pose_t.hpp"

namespace nodmap::slam6d {
namespace {

// 60 kB: with its head a part stays below 64 KiB.
constexpr std::size_t kPointsPerChunk = 5000;

std::int8_t pose_state(const PoseUpdate& update) {
  if (!update.registration) {
    // The first sweep is the map; what is too thin to be registered follows odometry.
    return update.keyframe ? nodmap::pose_t::TRACKING : nodmap::pose_t::DEGRADED;
  }
  switch (update.registration->status) {
    case RegistrationStatus::kTracking:
      return nodmap::pose_t::TRACKING;
    case RegistrationStatus::kDegraded:
      return nodmap::pose_t::DEGRADED;
    case RegistrationStatus::kLost:
      return nodmap::pose_t::LOST;
  }
  return nodmap::pose_t::LOST;
}

OccupancyMap::Options map_options(const OccupancyParams& params) {
  return {.resolution_m = params.resolution_m, .max_range_m = params.max_range_m};
}

}  // namespace

Slam6dNode::Slam6dNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(context.counts),
      slam_(params),
      occupancy_(map_options(params.occupancy)) {
  // While a keyframe is registered a second may pass: 75 scans and 100 odometry messages.
  constexpr int kQueue = 256;
  context.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { on_odometry(message); }, kQueue);
  context.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); }, kQueue);
  context.bus.subscribe<nodmap::save_request_t>(
      "SAVE_REQUEST", [this](const nodmap::save_request_t& message) { on_save_request(message); });
}

void Slam6dNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  if (input_.odometry_restarted()) {
    answer(slam_.change_odometry_frame(*T_odom_base));
  }
  slam_.add_odometry(message.utime, *T_odom_base);
  context_.counts.use();
}

void Slam6dNode::on_scan(const nodmap::scan_t& message) {
  scan::Scan scan;
  if (!input_.read(message, scan)) {
    return;
  }
  answer(slam_.add_scan(std::move(scan)));
  publish_octomap_part();
}

void Slam6dNode::finish() {
  answer(slam_.flush());
  const auto publish_rest = [this] {
    while (!octomap_.is_empty()) {
      publish_octomap_part();
    }
  };
  publish_rest();
  // What came within the period since the last map.
  if (params_.occupancy.publish_period_s > 0.0 && octomap_keyframes_ < slam_.keyframes().size()) {
    begin_octomap();
    publish_rest();
  }
}

// What becomes of a scan is known when its sweep is complete.
void Slam6dNode::count_scans() {
  const Metrics metrics = slam_.metrics();
  const std::size_t without_pose = metrics.scans_without_pose - counted_without_pose_;
  const std::size_t used = metrics.scans_in_sweeps - counted_scans_ - without_pose;
  for (std::size_t i = 0; i < used; ++i) {
    context_.counts.use();
  }
  for (std::size_t i = 0; i < without_pose; ++i) {
    context_.counts.reject("no_odometry");
  }
  counted_scans_ = metrics.scans_in_sweeps;
  counted_without_pose_ = metrics.scans_without_pose;
}

void Slam6dNode::answer(const std::optional<PoseUpdate>& update) {
  count_scans();
  if (update) {
    publish(*update);
  }
}

void Slam6dNode::publish(const PoseUpdate& update) {
  nodmap::pose_t message =
      node::write_corrected_pose(update.utime_us, update.T_map_base, update.T_map_odom);
  if (update.registration) {
    message.inlier_ratio = update.registration->inlier_ratio;
    message.inlier_rms_m = update.registration->residual_rms_m;
  }
  message.state = pose_state(update);
  context_.bus.publish("POSE_6D", message);
  if (update.keyframe) {
    answer_keyframe(slam_.keyframes().back());
  }
}

void Slam6dNode::answer_keyframe(const Keyframe& keyframe) {
  publish_cloud(keyframe);
  occupancy_.insert(keyframe.cloud, keyframe.T_map_base);
  const double age_s = 1e-6 * static_cast<double>(keyframe.cloud.utime_us - octomap_utime_us_);
  // A clock set back must not silence it until it has caught up.
  const bool is_due =
      octomap_keyframes_ == 0 || age_s < 0.0 || age_s >= params_.occupancy.publish_period_s;
  if (params_.occupancy.publish_period_s > 0.0 && is_due && octomap_.is_empty()) {
    begin_octomap();
  }
  const auto every = static_cast<std::size_t>(params_.occupancy.save_every_keyframes);
  if (every > 0 && slam_.keyframes().size() % every == 0 && !context_.out_dir.empty()) {
    save_map_while_running();
  }
}

void Slam6dNode::publish_cloud(const Keyframe& keyframe) {
  const std::vector<OrientedPoint>& points = keyframe.points;
  nodmap::cloud_chunk_t message{};
  message.utime = keyframe.cloud.utime_us;
  message.keyframe_id = static_cast<std::int64_t>(slam_.keyframes().size()) - 1;
  message.num_chunks =
      static_cast<std::int32_t>((points.size() + kPointsPerChunk - 1) / kPointsPerChunk);
  node::write_pose(keyframe.T_map_base, message.position_m, message.orientation);
  for (; message.chunk_index < message.num_chunks; ++message.chunk_index) {
    const std::size_t first = static_cast<std::size_t>(message.chunk_index) * kPointsPerChunk;
    const std::size_t end = std::min(first + kPointsPerChunk, points.size());
    message.num_points = static_cast<std::int32_t>(end - first);
    message.points_m.clear();
    for (std::size_t i = first; i < end; ++i) {
      const Eigen::Vector3f& p = points[i].p;
      message.points_m.push_back({p.x(), p.y(), p.z()});
    }
    context_.bus.publish("CLOUD", message);
  }
}

void Slam6dNode::begin_octomap() {
  octomap_utime_us_ = slam_.keyframes().back().cloud.utime_us;
  octomap_keyframes_ = slam_.keyframes().size();
  if (auto file = occupancy_.encode(OccupancyMap::Format::kBt)) {
    octomap_.begin(octomap_utime_us_, std::move(*file));
  }
}

void Slam6dNode::publish_octomap_part() {
  if (octomap_.is_empty()) {
    return;
  }
  const OctomapParts::Part part = octomap_.next();
  nodmap::octomap_chunk_t message{};
  message.utime = part.utime_us;
  message.map_revision = part.revision;
  message.chunk_index = part.index;
  message.num_chunks = part.count;
  message.num_bytes = static_cast<std::int32_t>(part.bytes.size());
  message.bytes.assign(part.bytes.begin(), part.bytes.end());
  context_.bus.publish("OCTOMAP", message);
}

void Slam6dNode::on_save_request(const nodmap::save_request_t& message) {
  if (node::accept_save_request(message, context_)) {
    save_map_while_running();
  }
}

// A full disk does not end the mapping: the last map that was whole stays, and STATUS says so.
void Slam6dNode::save_map_while_running() {
  save_error_ = save_map(context_.out_dir);
  if (save_error_) {
    log::get().warn("{}: map not saved: {}", context_.out_dir.string(), save_error_.message());
  }
}

std::error_code Slam6dNode::save_map(const std::filesystem::path& dir) {
  using Format = OccupancyMap::Format;
  std::vector<std::pair<Format, const char*>> files{{Format::kBt, "map.bt"}};
  if (params_.occupancy.save_ot) {
    files.emplace_back(Format::kOt, "map.ot");
  }
  for (const auto& [format, name] : files) {
    const auto bytes = occupancy_.encode(format);
    if (!bytes) {
      return std::make_error_code(std::errc::io_error);
    }
    if (const auto error = formats::replace_file(dir / name, *bytes)) {
      return error;
    }
  }
  ++maps_saved_;
  return {};
}

void Slam6dNode::write_results(const std::filesystem::path& dir) {
  if (const auto error = save_map(dir)) {
    throw std::runtime_error((dir / "map.bt").string() + ": " + error.message());
  }
  write_trajectories(slam_, dir);
  write_cloud(slam_, dir);
}

nlohmann::json Slam6dNode::metrics() const {
  nlohmann::json figures = slam_figures(slam_);
  figures["occupancy_map"] = {{"nodes", occupancy_.num_nodes()},
                              {"memory_bytes", occupancy_.memory_bytes()},
                              {"times_saved", maps_saved_}};
  return figures;
}

node::Health Slam6dNode::health() const {
  using node::HealthState;
  if (save_error_) {
    return {HealthState::kDegraded, "The map cannot be saved: " + save_error_.message() + "."};
  }
  if (slam_.metrics().scans_in_sweeps > 0 && slam_.sweeps().empty()) {
    return {HealthState::kDegraded, "There are scans, but no odometry for them."};
  }
  if (!slam_.sweeps().empty() && slam_.sweeps().back().num_points == 0) {
    return {HealthState::kDegraded,
            "The last sweep has no point between range.min_m and range.max_m."};
  }
  if (!slam_.sweeps().empty() && pose_state(slam_.sweeps().back()) == nodmap::pose_t::LOST) {
    return {HealthState::kDegraded, "The last sweep does not fit the map."};
  }
  return {};
}

}  // namespace nodmap::slam6d
