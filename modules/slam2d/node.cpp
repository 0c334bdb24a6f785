// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/node.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "common/node/results.hpp"
#include "modules/slam2d/map_file.hpp"
#include "modules/slam2d/messages.hpp"
#include "modules/slam2d/results.hpp"
#include "modules/slam2d/saved_map_file.hpp"

namespace nodmap::slam2d {
namespace {

// Limits of the work on the grid with each scan.
constexpr std::size_t kMaxCheckedPerScan = 100;
constexpr std::size_t kMaxRedrawnPerScan = 2;

constexpr time::Duration kGraphPeriod = 1s;

}  // namespace

Slam2dNode::Slam2dNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(params.level_scans, context.counts, &context.bus),
      slam_(params),
      map_(params.grid.cell_size_m),
      map_publisher_(context.bus, time::from_seconds(params.grid.publish_period_s)),
      saving_(context) {
  context_.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { input_.read(message); });
  context_.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); });
  context_.bus.subscribe<nodmap::clear_request_t>(
      "CLEAR_REQUEST",
      [this](const nodmap::clear_request_t& message) { on_clear_request(message); });
  context_.bus.subscribe<nodmap::save_request_t>(
      "SAVE_REQUEST", [this](const nodmap::save_request_t& message) { on_save_request(message); });
}

Slam2dNode::Slam2dNode(node::Context& context, const Params& params,
                       const node::MapOptions& options)
    : Slam2dNode(context, params) {
  SavedMap saved = read_saved_map(options.map_in);
  map_.restore_cleared(saved.cleared);
  slam_.restore(std::move(saved));
  num_restored_ = slam_.keyframes().size();
  map_.draw_new(slam_.keyframes());
  search_ = std::make_unique<Search>(map_.grid(), params, options.T_map_start);
  log::get().info("continues a map of {} keyframes in {} submaps", num_restored_,
                  slam_.back_end().submaps().size());
}

void Slam2dNode::on_scan(const nodmap::scan_t& message) {
  const std::optional<LevelScan> scan = input_.read(message);
  if (saving_.is_retry_due(input_.scan_stamp())) {
    save();
  }
  if (!scan) {
    return;
  }
  if (const auto update =
          search_ ? std::optional(find_in_saved_map(*scan)) : slam_.add_scan(*scan)) {
    answer(*update);
  } else {
    context_.counts.reject("too_few_points");
  }
}

void Slam2dNode::answer(const PoseUpdate& update) {
  context_.counts.use();
  last_state_ = update.state;
  last_stamp_ = update.stamp;
  context_.bus.publish("POSE_2D", write_pose(update, input_.input().T_odom_published()));
  if (!search_) {
    update_grid(update);
    if (time::is_due(update.stamp, last_graph_stamp_, kGraphPeriod)) {
      publish_graph(update.stamp);
    }
  } else if (update.state == PoseState::kTracking) {
    // The map is continued only once the pose is confirmed: a wrong pose would spoil the map.
    slam_.begin_at(update.T_map_odom);
    search_.reset();
  }
  map_publisher_.publish_if_due(map_.grid(), update.stamp);
}

void Slam2dNode::update_grid(const PoseUpdate& update) {
  if (update.is_keyframe && slam_.dropped_keyframes()) {
    const DroppedKeyframes& dropped = *slam_.dropped_keyframes();
    map_.drop(dropped);
    num_restored_ -=
        std::clamp(num_restored_, dropped.first, dropped.first + dropped.keyframes.size()) -
        dropped.first;
  }
  map_.draw_new(slam_.keyframes());
  map_.redraw_moved(slam_.keyframes(), kMaxCheckedPerScan, kMaxRedrawnPerScan);
}

PoseUpdate Slam2dNode::find_in_saved_map(const LevelScan& scan) {
  const PoseUpdate update = search_->localiser.add_scan(scan);
  search_metrics_ = search_->localiser.metrics();
  return update;
}

void Slam2dNode::on_clear_request(const nodmap::clear_request_t& message) {
  const Region region{Eigen::Map<const Eigen::Vector2d>(message.low_m),
                      Eigen::Map<const Eigen::Vector2d>(message.high_m)};
  if (!is_plausible(region)) {
    context_.counts.reject("implausible_clear_request");
    return;
  }
  if (!map_.clear(region)) {
    context_.counts.reject("too_many_cleared_regions");
    return;
  }
  context_.counts.use();
  log::get().info("{} cleared the map from ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) m",
                  node::read_name(message.requested_by), region.low.x(), region.low.y(),
                  region.high.x(), region.high.y());
}

void Slam2dNode::on_save_request(const nodmap::save_request_t& message) {
  if (saving_.accept(message, input_.scan_stamp())) {
    save();
  }
}

void Slam2dNode::save() {
  saving_.record(save_map(context_.out_dir), input_.scan_stamp());
}

std::error_code Slam2dNode::save_map(const std::filesystem::path& dir) const {
  const auto error = write_ros_map(dir, map_.grid());
  if (error || slam_.keyframes().empty()) {
    return error;
  }
  SavedMap saved = slam_.back_end().save();
  saved.cleared = map_.cleared();
  return write_saved_map(dir, saved);
}

void Slam2dNode::finish() {
  slam_.polish();
  map_.redraw_all_moved(slam_.keyframes());
  map_publisher_.publish_rest(map_.grid(), last_stamp_);
  publish_graph(last_stamp_);
  const BackEndMetrics& loops = slam_.back_end().metrics();
  log::get().info(
      "{} loops closed between {} submaps: {} by a match, {} by {} searches; refused: {} fitted "
      "poorly, {} fitted several places, {} contradicted the graph, {} saw through walls",
      loops.loops_tracked + loops.loops_searched, slam_.back_end().submaps().size(),
      loops.loops_tracked, loops.loops_searched, loops.searches, loops.refused_match,
      loops.refused_ambiguous, loops.refused_by_graph, loops.refused_by_view);
}

void Slam2dNode::publish_graph(time::Timestamp stamp) {
  if (graph_revision_published_ == slam_.back_end().graph_revision()) {
    return;
  }
  context_.bus.publish("POSE_GRAPH", write_graph(stamp, slam_.back_end()));
  graph_revision_published_ = slam_.back_end().graph_revision();
  last_graph_stamp_ = stamp;
}

void Slam2dNode::write_results(const std::filesystem::path& dir) {
  const std::vector<geometry::SE2> path = slam_.trajectory();
  formats::Trajectory corrected;
  formats::Trajectory online;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const TrackedScan& scan = slam_.tracked_scans()[i];
    corrected.push_back({scan.stamp, geometry::to_se3(path[i])});
    online.push_back({scan.stamp, geometry::to_se3(scan.T_map_base_online)});
  }
  std::vector<geometry::SE2> odometry;
  for (const Keyframe& keyframe : slam_.keyframes().subspan(num_restored_)) {
    odometry.push_back(keyframe.T_odom_base);
  }
  if (corrected.empty()) {
    log::get().warn(search_ ? "the robot was not found in the saved map"
                            : "the map is empty: no scan was used");
  }
  const auto save = [&] {
    if (const auto error = save_map(dir)) {
      throw std::system_error(error, dir.string() + ": cannot save the map");
    }
  };
  node::write_each({save,  // first what cannot be had again
                    [&] { formats::write_tum(dir / "trajectory.tum", corrected); },
                    [&] { formats::write_tum(dir / "online.tum", online); },
                    [&] { draw_map(map_.grid(), path).write_png(dir / "map.png"); },
                    [&] { draw_paths(path, odometry).write_png(dir / "path.png"); }});
}

nlohmann::json Slam2dNode::metrics() const {
  const Metrics& metrics = slam_.metrics();
  const BackEndMetrics& back_end = slam_.back_end().metrics();
  const double scans = static_cast<double>(std::max<std::int64_t>(1, metrics.scans.all));
  ScansByState all_scans = metrics.scans;
  all_scans += search_metrics_.scans;
  nlohmann::json result = scan_metrics(all_scans, input_.input().counts());
  result.update({{"mean_inlier_ratio", metrics.inlier_ratio_sum / scans},
                 {"mean_score", metrics.score_sum / scans},
                 {"map_points", slam_.back_end().num_points()},
                 {"maps_published", map_publisher_.num_published()},
                 {"keyframes", slam_.keyframes().size()},
                 {"submaps", slam_.back_end().submaps().size()},
                 {"submaps_dropped", back_end.submaps_dropped}});
  result["localisation"] = {
      {"keyframes_restored", num_restored_},
      {"searches", slam_.search_counts().searches + search_metrics_.searches},
      {"searches_found", slam_.search_counts().found + search_metrics_.found}};
  result["loops"] = {{"tracked", back_end.loops_tracked},
                     {"searched", back_end.loops_searched},
                     {"searches", back_end.searches},
                     {"refused_ambiguous", back_end.refused_ambiguous},
                     {"refused_match", back_end.refused_match},
                     {"refused_by_graph", back_end.refused_by_graph},
                     {"refused_by_view", back_end.refused_by_view},
                     {"optimisations", back_end.optimisations}};
  return result;
}

node::Health Slam2dNode::health() const {
  if (const auto problem = saving_.problem()) {
    return *problem;
  }
  if (search_ && last_state_ != PoseState::kTracking) {
    return {node::HealthState::kDegraded, "The robot has not been found in the saved map yet."};
  }
  if (last_state_ == PoseState::kLost) {
    return {node::HealthState::kDegraded, "Lost: the scan does not fit the map."};
  }
  if (last_state_ == PoseState::kOdometry) {
    return {node::HealthState::kDegraded,
            "Odometry only: the scan has too few points or does not fit the map."};
  }
  return {};
}

}  // namespace nodmap::slam2d
