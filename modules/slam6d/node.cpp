// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/node.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/formats/atomic_file.hpp"
#include "common/node/log.hpp"
#include "common/node/message_input.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/messages.hpp"
#include "modules/slam6d/results.hpp"
#include "modules/slam6d/saved_map_file.hpp"
#include "nodmap/octomap_chunk_t.hpp"

namespace nodmap::slam6d {
namespace {

// How many scans after its last one a sweep's pose is published, and a keyframe's map: 50 ms at 75
// Hz for what takes 10 ms, and 0.8 s, before the next sweep.
constexpr int kScansUntilRegistered = 4;
constexpr int kScansUntilMapped = 60;
// A disk that was full may have room again: 10 s.
constexpr int kScansUntilSavedAgain = 750;
// A search of a whole saved map takes up to half a second.
constexpr int kScansUntilFound = 60;
// Of a keyframe that is saved, 174 kB: 3 ms.
constexpr std::size_t kSavedKeyframesPerScan = 4;
constexpr time::Duration kGraphPeriod = 1s;
// Keyframes that have moved by less leave the occupancy map as it is, until the end.
constexpr double kMinMapMotionM = 0.03;
constexpr double kMinMapMotionAtEndM = 0.005;

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
  // On a busy machine a second may pass: 75 scans and 100 odometry messages.
  constexpr int kQueue = 256;
  context.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { on_odometry(message); }, kQueue);
  context.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); }, kQueue);
  context.bus.subscribe<nodmap::save_request_t>(
      "SAVE_REQUEST", [this](const nodmap::save_request_t& message) { on_save_request(message); });
}

Slam6dNode::Slam6dNode(node::Context& context, const Params& params,
                       const node::MapOptions& options)
    : Slam6dNode(context, params) {
  only_localises_ = !options.localise_in.empty();
  std::optional<geometry::SE3> T_map_start;
  if (options.T_map_start) {
    T_map_start = geometry::to_se3(*options.T_map_start);
  }
  slam_.restore(read_saved_map(only_localises_ ? options.localise_in : options.map_in), T_map_start,
                only_localises_);
  log::get().info("{} {} keyframes", only_localises_ ? "localises in" : "carries on with",
                  slam_.num_restored());
}

void Slam6dNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  if (input_.odometry_restarted()) {
    answer(registering_.take());
    answer(slam_.change_odometry_frame(*T_odom_base));
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
  answer(registering_.count_message());
  answer(mapping_.count_message());
  if (save_error_ && --scans_until_saved_again_ <= 0 && !mapping_.is_running() &&
      !registering_.is_running()) {
    start_saving();
  }
  if (auto sweep = slam_.collect(std::move(scan))) {
    register_sweep(std::move(*sweep));
  }
  count_scans();
  publish_restored_cloud();
  publish_octomap_part();
}

void Slam6dNode::register_sweep(PlacedSweep sweep) {
  answer(registering_.take());
  registering_.start([this, sweep = std::move(sweep)] { return slam_.add_sweep(sweep); },
                     slam_.may_search() ? kScansUntilFound : kScansUntilRegistered);
}

void Slam6dNode::finish() {
  answer(registering_.take());
  answer(slam_.flush());
  count_scans();
  slam_.polish();
  if (!slam_.keyframes().empty()) {
    publish_graph(slam_.keyframes().back().cloud->stamp);
  }
  if (slam_.back_end().has_loops()) {
    log::get().info("{}", describe_loops(slam_.back_end()));
  }
  if (only_localises_) {
    return;
  }
  answer(mapping_.take());
  update_map(kMinMapMotionAtEndM);
  const auto publish_rest = [this] {
    answer(mapping_.take());
    while (!octomap_.is_empty()) {
      publish_octomap_part();
    }
  };
  publish_rest();
  // What came within the period since the last map.
  if (params_.occupancy.publish_period_s > 0.0 && octomap_keyframes_ < slam_.keyframes().size()) {
    octomap_stamp_ = slam_.keyframes().back().cloud->stamp;
    answer(MapWork{.bt_file = occupancy_.encode(OccupancyMap::Format::kBt)});
    publish_rest();
  }
}

// What becomes of a scan is known when its sweep is complete.
void Slam6dNode::count_scans() {
  const ScanCounts& scans = slam_.scan_counts();
  const std::size_t without_pose = scans.without_pose - counted_.without_pose;
  const std::size_t used = scans.in_sweeps - counted_.in_sweeps - without_pose;
  for (std::size_t i = 0; i < used; ++i) {
    context_.counts.use();
  }
  for (std::size_t i = 0; i < without_pose; ++i) {
    context_.counts.reject("no_odometry");
  }
  counted_ = scans;
}

void Slam6dNode::answer(const std::optional<PoseUpdate>& update) {
  if (update) {
    publish(*update);
  }
}

void Slam6dNode::publish(const PoseUpdate& update) {
  context_.bus.publish("POSE_6D", write_pose(update));
  if (update.keyframe) {
    publish_cloud(slam_.keyframes().size() - 1);
  }
  if (std::chrono::abs(update.stamp - graph_stamp_) >= kGraphPeriod) {
    publish_graph(update.stamp);
  }
  update_map(kMinMapMotionM);
}

// One with each scan, so that no queue runs over.
void Slam6dNode::publish_restored_cloud() {
  if (restored_clouds_ < slam_.num_restored() && !registering_.is_running()) {
    publish_cloud(restored_clouds_++);
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

void Slam6dNode::publish_cloud(std::size_t k) {
  for (const nodmap::cloud_chunk_t& chunk : write_cloud_chunks(slam_.keyframes()[k], k)) {
    context_.bus.publish("CLOUD", chunk);
  }
}

bool Slam6dNode::has_moved(double min_motion_m) const {
  for (std::size_t k = 0; k < T_map_mapped_.size(); ++k) {
    const geometry::SE3& T_map_base = slam_.keyframes()[k].T_map_base;
    if ((T_map_base.translation() - T_map_mapped_[k].translation()).norm() > min_motion_m) {
      return true;
    }
  }
  return false;
}

// One piece of work at a time: what comes meanwhile waits for its end. A map whose keyframes have
// moved is made anew.
void Slam6dNode::update_map(double min_motion_m) {
  if (mapping_.is_running() || only_localises_) {
    return;
  }
  const std::span<const Keyframe> all = slam_.keyframes();
  const bool is_anew =
      T_map_mapped_.empty() || all.size() < T_map_mapped_.size() || has_moved(min_motion_m);
  if (is_anew) {
    T_map_mapped_.clear();
  }
  const std::span<const Keyframe> added = all.subspan(T_map_mapped_.size());
  if (added.empty()) {
    return;
  }
  const bool is_published = begin_octomap(added.back().cloud->stamp);
  const auto every = static_cast<std::size_t>(params_.occupancy.save_every_keyframes);
  const bool is_saved =
      every > 0 && all.size() / every > T_map_mapped_.size() / every && !context_.out_dir.empty();
  std::vector<std::pair<std::shared_ptr<const SweepCloud>, geometry::SE3>> clouds;
  for (const Keyframe& keyframe : added) {
    clouds.emplace_back(keyframe.cloud, keyframe.T_map_base);
    T_map_mapped_.push_back(keyframe.T_map_base);
  }
  std::optional<SavedMap> saved;
  if (is_saved) {
    saved = slam_.save();
  }
  // A scan more for each cloud.
  const int scans_until_due =
      kScansUntilMapped +
      static_cast<int>(clouds.size() + (is_saved ? all.size() / kSavedKeyframesPerScan : 0));
  mapping_.start(
      [this, clouds = std::move(clouds), saved = std::move(saved), is_anew, is_published] {
        MapWork work;
        if (is_anew) {
          occupancy_ = OccupancyMap(map_options(params_.occupancy));
        }
        for (const auto& [cloud, T_map_base] : clouds) {
          occupancy_.insert(*cloud, T_map_base);
        }
        if (is_published) {
          work.bt_file = occupancy_.encode(OccupancyMap::Format::kBt);
        }
        if (saved) {
          work.save_error = save_map(context_.out_dir, *saved);
        }
        return work;
      },
      scans_until_due);
}

// Returns whether the next map is to be published, which then is of `stamp`.
bool Slam6dNode::begin_octomap(time::Timestamp stamp) {
  const double age_s = time::seconds(stamp - octomap_stamp_);
  // A clock set back must not silence it until it has caught up.
  const bool is_due =
      octomap_keyframes_ == 0 || age_s < 0.0 || age_s >= params_.occupancy.publish_period_s;
  if (params_.occupancy.publish_period_s <= 0.0 || !is_due || !octomap_.is_empty()) {
    return false;
  }
  octomap_stamp_ = stamp;
  octomap_keyframes_ = slam_.keyframes().size();
  return true;
}

void Slam6dNode::answer(const std::optional<MapWork>& work) {
  if (!work) {
    return;
  }
  if (work->bt_file) {
    octomap_.begin(octomap_stamp_, *work->bt_file);
  }
  // A full disk does not end the mapping: the last map that was whole stays, and STATUS says so.
  if (work->save_error) {
    save_error_ = *work->save_error;
    scans_until_saved_again_ = kScansUntilSavedAgain;
    maps_saved_ += save_error_ ? 0 : 1;
    if (save_error_) {
      log::get().warn("{}: map not saved: {}", context_.out_dir.string(), save_error_.message());
    } else {
      log::get().info("map saved in {}", context_.out_dir.string());
    }
  }
}

void Slam6dNode::publish_octomap_part() {
  if (octomap_.is_empty()) {
    return;
  }
  const OctomapParts::Part part = octomap_.next();
  nodmap::octomap_chunk_t message{};
  message.utime = time::to_utime(part.stamp);
  message.map_revision = part.revision;
  message.chunk_index = part.index;
  message.num_chunks = part.count;
  message.num_bytes = static_cast<std::int32_t>(part.bytes.size());
  message.bytes.assign(part.bytes.begin(), part.bytes.end());
  context_.bus.publish("OCTOMAP", message);
}

void Slam6dNode::on_save_request(const nodmap::save_request_t& message) {
  if (!only_localises_ && node::accept_save_request(message, context_)) {
    answer(registering_.take());
    answer(mapping_.take());
    start_saving();
  }
}

void Slam6dNode::start_saving() {
  mapping_.start(
      [this, saved = slam_.save()] {
        return MapWork{.save_error = save_map(context_.out_dir, saved)};
      },
      kScansUntilMapped + static_cast<int>(slam_.keyframes().size() / kSavedKeyframesPerScan));
}

std::error_code Slam6dNode::save_map(const std::filesystem::path& dir,
                                     const SavedMap& keyframes) const {
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
  return keyframes.keyframes.empty() ? std::error_code{} : write_saved_map(dir, keyframes);
}

void Slam6dNode::write_results(const std::filesystem::path& dir) {
  write_trajectories(slam_, dir);
  if (only_localises_) {
    return;
  }
  if (const auto error = save_map(dir, slam_.save())) {
    throw std::system_error(error, dir.string());
  }
  ++maps_saved_;
  write_cloud(slam_, params_.cloud, dir);
}

nlohmann::json Slam6dNode::metrics() const {
  registering_.wait();
  mapping_.wait();
  nlohmann::json figures = slam_figures(slam_);
  figures["loops"] = loop_figures(slam_.back_end());
  if (slam_.localiser()) {
    figures["localisation"] = localisation_figures(slam_);
  }
  figures["occupancy_map"] = {{"nodes", occupancy_.num_nodes()},
                              {"memory_bytes", occupancy_.memory_bytes()},
                              {"times_saved", maps_saved_}};
  return figures;
}

node::Health Slam6dNode::health() const {
  using node::HealthState;
  registering_.wait();
  if (save_error_) {
    return {HealthState::kDegraded, "The map cannot be saved: " + save_error_.message() + "."};
  }
  if (slam_.scan_counts().in_sweeps > 0 && slam_.sweeps().empty()) {
    return {HealthState::kDegraded, "There are scans, but no odometry for them."};
  }
  if (!slam_.sweeps().empty() && !slam_.sweeps().back().is_place_known) {
    return {HealthState::kDegraded, "The robot has not been found in the saved map yet."};
  }
  if (!slam_.sweeps().empty() && slam_.sweeps().back().num_points == 0) {
    return {HealthState::kDegraded,
            "The last sweep has no point between range.min_m and range.max_m."};
  }
  if (!slam_.sweeps().empty() && write_pose(slam_.sweeps().back()).state == nodmap::pose_t::LOST) {
    return {HealthState::kDegraded, "The last sweep does not fit the map."};
  }
  return {};
}

}  // namespace nodmap::slam6d
