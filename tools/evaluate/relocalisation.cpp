// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/relocalisation.hpp"

#include <algorithm>
#include <ctime>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/angle.hpp"
#include "common/node/log.hpp"
#include "common/node/message_counts.hpp"
#include "modules/slam2d/grid/map_file.hpp"
#include "modules/slam2d/localise/known_map.hpp"
#include "modules/slam2d/scan/level_scan_reader.hpp"
#include "tools/evaluate/group_relocaliser.hpp"
#include "tools/evaluate/trajectory_error.hpp"

namespace nodmap::evaluate {
namespace {

constexpr time::Duration kTolerance = 50ms;
constexpr double kRightM = 0.25;
constexpr double kRightRad = geometry::deg_to_rad(3.0);
constexpr std::size_t kDefaultGroups = 200;

// Calls `visit` with each level scan of a log. Returns what is damaged in it, or nothing.
std::string for_each_level_scan(const std::filesystem::path& log,
                                const std::function<void(const slam2d::LevelScan&)>& visit) {
  bus::LogReader reader(log);
  reader.require_event();
  node::MessageCounts counts;
  slam2d::LevelScanReader level_scans({}, counts);
  nodmap::scan_t scan{};
  nodmap::odometry_t odometry{};
  while (const bus::LogEvent* event = reader.next()) {
    if (event->channel == "ODOMETRY" && bus::decode_into(odometry, event->data)) {
      level_scans.read(odometry);
    } else if (event->channel == "SCAN" && bus::decode_into(scan, event->data)) {
      level_scans.read(scan);
      while (const auto level_scan = level_scans.next()) {
        visit(*level_scan);
      }
    }
  }
  return reader.skipped_bytes() > 0 ? reader.damage() : "";
}

// Successive level scans with copies of their points, because a scan's points are valid only until
// the next scan.
class Group {
 public:
  void add(const slam2d::LevelScan& scan) {
    points_.emplace_back(scan.points_base.begin(), scan.points_base.end());
    scans_.push_back(scan);
    scans_.back().points_base = points_.back();
  }
  void clear() {
    scans_.clear();
    points_.clear();
  }
  [[nodiscard]] std::size_t size() const { return scans_.size(); }
  [[nodiscard]] std::span<const slam2d::LevelScan> scans() const { return scans_; }

 private:
  std::vector<slam2d::LevelScan> scans_;
  std::vector<std::vector<slam2d::OrientedPoint>> points_;
};

int default_every(const std::filesystem::path& log, int num_scans) {
  std::size_t scans = 0;
  for_each_level_scan(log, [&scans](const slam2d::LevelScan&) { ++scans; });
  const std::size_t groups = scans / static_cast<std::size_t>(num_scans);
  return static_cast<int>(std::max<std::size_t>(1, groups / kDefaultGroups));
}

double cpu_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

bool is_right(const geometry::SE2& found, const geometry::SE2& truth) {
  return geometry::distance_m(found, truth) <= kRightM &&
         geometry::rotation_rad(found, truth) <= kRightRad;
}

}  // namespace

RelocalisationResult measure_relocalisation(const std::filesystem::path& map,
                                            const std::filesystem::path& log,
                                            const formats::Trajectory& truth,
                                            const RelocalisationPlan& plan) {
  const slam2d::Slam2dParams params;
  const slam2d::KnownMap known(slam2d::read_ros_map(map), params.map);
  const GroupRelocaliser relocaliser(params.relocalise, params.matcher);
  const int every = plan.every > 0 ? plan.every : default_every(log, plan.num_scans);
  Group group;
  int groups = 0;
  std::vector<double> ms;
  RelocalisationResult result;
  const std::string damage = for_each_level_scan(log, [&](const slam2d::LevelScan& scan) {
    if (group.size() == static_cast<std::size_t>(plan.num_scans)) {
      group.clear();
    }
    group.add(scan);
    if (group.size() < static_cast<std::size_t>(plan.num_scans) || groups++ % every != 0) {
      return;
    }
    const auto known_pose = associate({{scan.stamp, geometry::SE3::Identity()}}, truth, kTolerance);
    if (known_pose.empty()) {
      return;
    }
    const double begin_ms = cpu_ms();
    const slam2d::Relocalisation found = relocaliser.locate(known, group.scans());
    ms.push_back(cpu_ms() - begin_ms);
    ++result.n;
    if (found.status != slam2d::Relocalisation::Status::kFound) {
      ++result.said_lost;
    } else if (is_right(found.T_map_base, geometry::to_se2(known_pose.front().T_truth_base))) {
      ++result.right;
    } else {
      ++result.wrong;
    }
  });
  if (!damage.empty()) {
    log::get().warn("{}", damage);
  }
  if (!ms.empty()) {
    std::ranges::sort(ms);
    result.ms_p50 = ms[ms.size() / 2];
    result.ms_max = ms.back();
  }
  return result;
}

}  // namespace nodmap::evaluate
