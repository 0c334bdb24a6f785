// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/saved_map_file.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "common/bus/message_log.hpp"
#include "common/formats/input_file.hpp"
#include "common/node/messages.hpp"
#include "common/registration/pose_edges.hpp"
#include "common/scan/scan.hpp"
#include "nodmap/cleared_region_2d_t.hpp"
#include "nodmap/keyframe_2d_t.hpp"
#include "nodmap/loop_2d_t.hpp"
#include "nodmap/loop_statistics_2d_t.hpp"

namespace nodmap::slam2d {
namespace {

using registration::PoseEdge2d;

constexpr const char* kFileName = "keyframes.lcmlog";
constexpr const char* kKeyframeChannel = "KEYFRAME_2D";
constexpr const char* kLoopChannel = "LOOP_2D";
constexpr const char* kStatisticsChannel = "LOOP_STATISTICS_2D";
constexpr const char* kClearedChannel = "CLEARED_REGION_2D";

void write_pose(const geometry::SE2& pose, double (&out)[3]) {
  out[0] = pose.x;
  out[1] = pose.y;
  out[2] = pose.yaw;
}

geometry::SE2 read_pose(const double (&in)[3]) {
  return {in[0], in[1], in[2]};
}

void write_points(const SharedPoints& points, std::vector<std::vector<float>>& out) {
  out.reserve(points.size());
  for (const Eigen::Vector2f& p : points) {
    out.push_back({p.x(), p.y()});
  }
}

nodmap::keyframe_2d_t write_keyframe(const SavedMap& map, std::size_t k) {
  const Keyframe& keyframe = map.keyframes[k];
  nodmap::keyframe_2d_t message{};
  message.utime = time::to_utime(keyframe.stamp);
  const auto has_k = [k](const SavedMap::Submap& submap) {
    return submap.first_keyframe <= k && k < submap.end_keyframe;
  };
  const auto first = std::find_if(map.submaps.begin(), map.submaps.end(), has_k);
  const auto end = std::find_if_not(first, map.submaps.end(), has_k);
  message.first_submap = static_cast<std::int32_t>(first - map.submaps.begin());
  message.last_submap = static_cast<std::int32_t>(end - map.submaps.begin()) - 1;
  write_pose(keyframe.T_map_base, message.map_from_base);
  write_pose(keyframe.T_odom_base, message.odom_from_base);
  if (k > 0) {
    write_pose(map.steps[k - 1].T_from_to, message.step);
    node::write_matrix(map.steps[k - 1].information, message.step_information);
  }
  message.sensor_origin_m[0] = keyframe.sensor_origin_base.x();
  message.sensor_origin_m[1] = keyframe.sensor_origin_base.y();
  message.num_points = static_cast<std::int32_t>(keyframe.points_base.size());
  write_points(keyframe.points_base, message.points_m);
  write_points(keyframe.normals_base, message.normals);
  return message;
}

nodmap::loop_2d_t write_loop(const SavedMap::Loop& loop) {
  nodmap::loop_2d_t message{};
  message.from_submap = static_cast<std::int32_t>(loop.edge.from);
  message.to_submap = static_cast<std::int32_t>(loop.edge.to);
  write_pose(loop.edge.T_from_to, message.from_to);
  node::write_matrix(loop.edge.information, message.information);
  message.score = loop.score;
  return message;
}

nodmap::loop_statistics_2d_t write_statistics(const VarianceFactor& variance_factor) {
  nodmap::loop_statistics_2d_t message{};
  message.chi_squared_sum = variance_factor.chi_squared_sum();
  message.num_loops = variance_factor.num_loops();
  return message;
}

nodmap::cleared_region_2d_t write_cleared(const ClearedRegion& cleared) {
  nodmap::cleared_region_2d_t message{};
  message.num_keyframes = static_cast<std::int32_t>(cleared.num_keyframes);
  Eigen::Map<Eigen::Vector2d>(message.low_m) = cleared.region.low;
  Eigen::Map<Eigen::Vector2d>(message.high_m) = cleared.region.high;
  return message;
}

// Builds a map from messages; throws if one of them cannot be part of it.
class Reader {
 public:
  explicit Reader(const bus::MessageLogReader& log) : log_(log) {}

  void add(const bus::LogEvent& event) {
    if (event.channel == kKeyframeChannel) {
      add_keyframe(log_.decode<nodmap::keyframe_2d_t>(event));
    } else if (event.channel == kLoopChannel) {
      add_loop(log_.decode<nodmap::loop_2d_t>(event));
    } else if (event.channel == kStatisticsChannel) {
      add_statistics(log_.decode<nodmap::loop_statistics_2d_t>(event));
    } else if (event.channel == kClearedChannel) {
      add_cleared(log_.decode<nodmap::cleared_region_2d_t>(event));
    }
  }

  SavedMap finish() {
    require(!map_.keyframes.empty(), "no keyframe");
    for (const SavedMap::Loop& loop : map_.loops) {
      require(loop.edge.to < map_.submaps.size(), "a loop to a submap that does not exist");
    }
    for (const ClearedRegion& cleared : map_.cleared) {
      require(cleared.num_keyframes <= map_.keyframes.size(),
              "a cleared region with keyframes that do not exist");
    }
    return std::move(map_);
  }

  void require(bool holds, const std::string& problem) const { log_.require(holds, problem); }

 private:
  void require_within(double value, double limit) const {
    require(std::abs(value) <= limit,  // false for NaN
            "keyframe " + std::to_string(map_.keyframes.size()) + " holds an impossible number");
  }
  // Poses beyond 10^7 m are not real, and their cells would not fit into 32 bits.
  void require_finite(double value) const { require_within(value, 1e7); }

  [[nodiscard]] SharedPoints read_points(const std::vector<std::vector<float>>& message,
                                         double longest) const {
    std::vector<Eigen::Vector2f> points;
    for (const std::vector<float>& p : message) {
      points.emplace_back(p[0], p[1]);
      require_within(points.back().cast<double>().norm(), longest);
    }
    return SharedPoints(std::move(points));
  }

  void add_keyframe(const nodmap::keyframe_2d_t& message) {
    for (const auto* pose : {&message.map_from_base, &message.odom_from_base, &message.step}) {
      std::for_each(std::begin(*pose), std::end(*pose), [this](double v) { require_finite(v); });
    }
    require_within(Eigen::Map<const Eigen::Vector2d>(message.sensor_origin_m).norm(),
                   scan::kFarthestPointM);
    Keyframe keyframe{
        .stamp = node::stamp_of(message),
        .T_odom_base = read_pose(message.odom_from_base),
        .T_map_base = read_pose(message.map_from_base),
        .sensor_origin_base = {message.sensor_origin_m[0], message.sensor_origin_m[1]}};
    constexpr double kUnitRounded = 1.01;
    keyframe.points_base = read_points(message.points_m, scan::kFarthestPointM);
    keyframe.normals_base = read_points(message.normals, kUnitRounded);
    add_to_submaps(message.first_submap, message.last_submap);
    if (!map_.keyframes.empty()) {
      add_step(message);
    }
    map_.keyframes.push_back(std::move(keyframe));
  }

  // Each submap begins with the keyframe at which it is first named, and none may be left out.
  void add_to_submaps(std::int32_t first, std::int32_t last) {
    const std::size_t k = map_.keyframes.size();
    require(first >= 0 && first <= last && static_cast<std::size_t>(last) <= map_.submaps.size() &&
                (k == 0 || static_cast<std::size_t>(last) + 1 >= map_.submaps.size()),
            "keyframe " + std::to_string(k) + " is in impossible submaps");
    for (auto s = static_cast<std::size_t>(first); s <= static_cast<std::size_t>(last); ++s) {
      if (s == map_.submaps.size()) {
        map_.submaps.push_back({k, k});
      }
      require(map_.submaps[s].end_keyframe == k,
              "submap " + std::to_string(s) + " has a gap before keyframe " + std::to_string(k));
      map_.submaps[s].end_keyframe = k + 1;
    }
  }

  void add_step(const nodmap::keyframe_2d_t& message) {
    PoseEdge2d step;
    step.to = map_.keyframes.size();
    step.from = step.to - 1;
    step.T_from_to = read_pose(message.step);
    step.information = read_information(message.step_information);
    require(step.information.llt().info() == Eigen::Success,
            "step to keyframe " + std::to_string(step.to) + " with an unknown direction");
    map_.steps.push_back(step);
  }

  void add_loop(const nodmap::loop_2d_t& message) {
    require(message.from_submap >= 0 && message.from_submap < message.to_submap,
            "a loop between impossible submaps");
    SavedMap::Loop loop;
    loop.edge.from = static_cast<std::size_t>(message.from_submap);
    loop.edge.to = static_cast<std::size_t>(message.to_submap);
    loop.edge.T_from_to = read_pose(message.from_to);
    std::for_each(std::begin(message.from_to), std::end(message.from_to),
                  [this](double v) { require_finite(v); });
    loop.edge.information = read_information(message.information);
    loop.edge.may_be_wrong = true;
    loop.score = message.score;
    map_.loops.push_back(loop);
  }

  // Maps of earlier versions have none: then the factor begins as for a new map.
  void add_statistics(const nodmap::loop_statistics_2d_t& message) {
    constexpr double kMost = 1e9;
    require(message.num_loops >= 1.0 && message.num_loops <= kMost &&
                message.chi_squared_sum >= 0.0 && message.chi_squared_sum <= kMost,
            "impossible statistics of loops");
    map_.variance_factor = {message.chi_squared_sum, message.num_loops};
  }

  void add_cleared(const nodmap::cleared_region_2d_t& message) {
    const Region region{Eigen::Map<const Eigen::Vector2d>(message.low_m),
                        Eigen::Map<const Eigen::Vector2d>(message.high_m)};
    require(message.num_keyframes >= 0 && is_plausible(region), "an impossible cleared region");
    map_.cleared.push_back({region, static_cast<std::size_t>(message.num_keyframes)});
  }

  [[nodiscard]] Eigen::Matrix3d read_information(const double (&in)[3][3]) const {
    Eigen::Matrix3d information = node::read_matrix(in);
    require(registration::is_information(information),
            "an edge without a valid information matrix");
    return information;
  }

  const bus::MessageLogReader& log_;
  SavedMap map_;
};

}  // namespace

std::error_code write_saved_map(const std::filesystem::path& dir, const SavedMap& map) {
  bus::MessageLogWriter writer(dir / kFileName);
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    writer.write(map.keyframes[k].stamp, kKeyframeChannel, write_keyframe(map, k));
  }
  for (const SavedMap::Loop& loop : map.loops) {
    writer.write(map.keyframes.back().stamp, kLoopChannel, write_loop(loop));
  }
  writer.write(map.keyframes.back().stamp, kStatisticsChannel,
               write_statistics(map.variance_factor));
  for (const ClearedRegion& cleared : map.cleared) {
    writer.write(map.keyframes.back().stamp, kClearedChannel, write_cleared(cleared));
  }
  return writer.replace();
}

SavedMap read_saved_map(const std::filesystem::path& path) {
  if (path.extension() == ".yaml") {
    throw formats::InputFileError(path.string() +
                                  ": contains no keyframes, so it cannot be extended; --localise "
                                  "can use it, --map-in needs keyframes.lcmlog");
  }
  return bus::read_message_log<Reader>(path, kFileName);
}

}  // namespace nodmap::slam2d
