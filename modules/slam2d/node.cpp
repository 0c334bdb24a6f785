// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/node.hpp"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "common/node/results.hpp"
#include "modules/slam2d/back_end/saved_map_file.hpp"
#include "modules/slam2d/grid/map_file.hpp"
#include "modules/slam2d/messages.hpp"
#include "modules/slam2d/results.hpp"
#include "modules/slam2d/thread_executor.hpp"

namespace nodmap::slam2d {
namespace {

// Limits of the work on the grid with each scan.
constexpr std::size_t kMaxCheckedPerScan = 100;
constexpr std::size_t kMaxRedrawnPerScan = 2;

constexpr time::Duration kGraphPeriod = 1s;

}  // namespace

Slam2dNode::Slam2dNode(node::Context& context, const Params& params,
                       const node::MapOptions& options)
    : context_(context),
      input_(params.level_scans, context.counts, &context.bus),
      slam_(params, std::make_unique<ThreadExecutor>()),
      map_(params.grid.cell_size_m),
      map_publisher_(context.bus, time::from_seconds(params.grid.publish_period_s)),
      saving_(context),
      writing_(context.results_used) {
  if (!options.map_in.empty()) {
    continue_map(options);
  }
  context_.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { input_.read(message); });
  context_.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); });
  if (params.level_scans.from_structure_map) {
    context_.bus.subscribe<nodmap::egomap_t>(
        "STRUCTURE_MAP", [this](const nodmap::egomap_t& message) { on_structure_map(message); });
  }
  context_.bus.subscribe<nodmap::clear_request_t>(
      "CLEAR_REQUEST",
      [this](const nodmap::clear_request_t& message) { on_clear_request(message); });
  context_.bus.subscribe<nodmap::save_request_t>(
      "SAVE_REQUEST", [this](const nodmap::save_request_t& message) { on_save_request(message); });
}

void Slam2dNode::continue_map(const node::MapOptions& options) {
  SavedMap saved = read_saved_map(options.map_in);
  map_.restore_cleared(saved.cleared);
  map_.draw_new(saved.keyframes);
  slam_.restore(std::move(saved), trinary(map_.grid()), options.T_map_start);
  log::get().info("continues a map of {} keyframes in {} submaps", slam_.num_restored(),
                  slam_.back_end().submaps().size());
}

void Slam2dNode::on_scan(const nodmap::scan_t& message) {
  input_.read(message);
  answer_saved(writing_.count_message());
  save_if_due();
  add_level_scans();
}

void Slam2dNode::add_level_scans() {
  while (const std::optional<LevelScan> scan = input_.next()) {
    add_scan(*scan);
  }
}

void Slam2dNode::on_structure_map(const nodmap::egomap_t& message) {
  if (const std::optional<LevelScan> scan = input_.read(message)) {
    add_scan(*scan);
  }
}

void Slam2dNode::add_scan(const LevelScan& scan) {
  const std::optional<PoseUpdate> update = slam_.add_scan(scan);
  if (!update) {
    context_.counts.reject("too_few_points");
    return;
  }
  context_.counts.use();
  last_state_ = update->state;
  last_stamp_ = update->stamp;
  context_.bus.publish("POSE_2D", write_pose(*update, input_.input().T_odom_published()));
  if (!slam_.is_finding()) {
    update_grid();
    if (time::is_due(update->stamp, last_graph_stamp_, kGraphPeriod)) {
      publish_graph(update->stamp);
    }
  }
  map_publisher_.publish_if_due(map_.grid(), update->stamp);
}

void Slam2dNode::update_grid() {
  drop_from_grid();
  map_.draw_new(slam_.keyframes());
  map_.redraw_moved(slam_.keyframes(), kMaxCheckedPerScan, kMaxRedrawnPerScan);
}

void Slam2dNode::drop_from_grid() {
  if (const DroppedKeyframes* const dropped = slam_.dropped_keyframes()) {
    map_.drop(*dropped);
  }
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
  answer_saved(writing_.take_early());  // a save that failed after the last scan
  if (saving_.accept(message, input_.scan_stamp())) {
    save_if_due();
  }
}

// A replay waits for the disk at once: what it logs and when it tries again must not depend on it.
void Slam2dNode::save_if_due() {
  if (writing_.is_running() || !saving_.is_due(input_.scan_stamp())) {
    return;
  }
  saving_.begin();
  writing_.start(prepare_save(context_.out_dir), 0);
  answer_saved(writing_.take_early());
}

void Slam2dNode::answer_saved(const std::optional<std::error_code>& error) {
  if (error) {
    saving_.record(*error, input_.scan_stamp());
  }
}

std::function<std::error_code()> Slam2dNode::prepare_save(const std::filesystem::path& dir) {
  SavedMap saved = slam_.back_end().save();
  saved.cleared = map_.cleared();
  const auto map = std::make_shared<KeyframeGrid>(map_.snapshot());
  // After a loop many keyframes are still drawn where they were before.
  return [dir, map, saved = std::move(saved)]() -> std::error_code {
    if (saved.keyframes.empty()) {
      return {};  // no map yet; a former one stays
    }
    map->redraw_all_moved(saved.keyframes);
    const auto error = write_ros_map(dir, map->grid());
    return error ? error : write_saved_map(dir, saved);
  };
}

// On a slow disk, to polish a large map and to save it may take longer than the time that a process
// has to stop before it is killed. Until then the newest keyframes would be in memory only.
void Slam2dNode::save_unpolished() {
  if (!context_.out_dir.empty() && !slam_.keyframes().empty()) {
    answer_saved(prepare_save(context_.out_dir)());
  }
}

void Slam2dNode::finish() {
  input_.end_scans();
  add_level_scans();
  input_.finish();
  answer_saved(writing_.take());
  slam_.finish_loops();
  drop_from_grid();
  save_unpolished();
  slam_.polish();
  map_.redraw_all_moved(slam_.keyframes());
  map_publisher_.publish_rest(map_.grid(), last_stamp_);
  publish_graph(last_stamp_);
  log_scans(slam_.metrics().scans);
  const BackEndMetrics loops = slam_.back_end().metrics();
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
  std::vector<geometry::SE2> odometry;
  for (const Keyframe& keyframe : slam_.keyframes().subspan(slam_.num_restored())) {
    odometry.push_back(keyframe.T_odom_base);
  }
  if (path.empty()) {
    log::get().warn(slam_.is_finding() ? "the robot was not found in the saved map"
                                       : "the map is empty: no scan was used");
  }
  const auto save = [&] {
    if (const auto error = prepare_save(dir)()) {
      throw std::system_error(error, dir.string() + ": cannot save the map");
    }
  };
  node::write_each({save,  // first what cannot be had again
                    [&] { write_trajectories(dir, slam_.tracked_scans(), path); },
                    [&] { draw_map(map_.grid(), path).write_png(dir / "map.png"); },
                    [&] { draw_paths(path, odometry).write_png(dir / "path.png"); }});
}

nlohmann::json Slam2dNode::metrics() const {
  const Metrics metrics = slam_.metrics();
  const BackEndMetrics back_end = slam_.back_end().metrics();
  const double scans = static_cast<double>(std::max<std::int64_t>(1, metrics.scans.all));
  nlohmann::json result = scan_metrics(metrics.scans, input_.input().counts());
  result.update({{"mean_inlier_ratio", metrics.inlier_ratio_sum / scans},
                 {"mean_score", metrics.score_sum / scans},
                 {"map_points", slam_.back_end().num_points()},
                 {"rays_beyond_grid", map_.rays_beyond()},
                 {"maps_published", map_publisher_.num_published()},
                 {"keyframes", slam_.keyframes().size()},
                 {"submaps", slam_.back_end().submaps().size()},
                 {"submaps_dropped", back_end.submaps_dropped}});
  result["localisation"] = {{"keyframes_restored", slam_.num_restored()},
                            {"searches", metrics.searches.made},
                            {"searches_found", metrics.searches.found}};
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
  if (slam_.is_finding() && last_state_ != PoseState::kTracking) {
    return {node::HealthState::kDegraded, "The robot has not been found in the saved map yet."};
  }
  if (last_state_ == PoseState::kTracking && map_.rays_beyond() > 0) {
    return {node::HealthState::kDegraded,
            "A part of the map is missing: it needs a grid of more than 64 million cells. Use a "
            "larger grid.cell_size_m."};
  }
  return health_of(last_state_, input_.input().lacks_odometry());
}

}  // namespace nodmap::slam2d
