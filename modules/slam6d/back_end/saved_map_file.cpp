// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/saved_map_file.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/bus/message_log.hpp"
#include "common/formats/input_file.hpp"
#include "common/node/messages.hpp"
#include "common/registration/pose_edges.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"
#include "nodmap/keyframe_6d_t.hpp"
#include "nodmap/loop_6d_t.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using registration::PoseEdge3d;

constexpr const char* kFileName = "keyframes.lcmlog";
constexpr const char* kKeyframeChannel = "KEYFRAME_6D";
constexpr const char* kLoopChannel = "LOOP_6D";

nodmap::keyframe_6d_t write_keyframe(const SavedMap& map, std::size_t k) {
  const SavedMap::Keyframe& keyframe = map.keyframes[k];
  nodmap::keyframe_6d_t message{};
  message.utime = time::to_utime(keyframe.cloud->stamp);
  node::write_pose(keyframe.T_map_base, message.position_m, message.orientation);
  message.is_level = keyframe.is_level ? 1 : 0;
  message.step_from = -1;
  if (k > 0) {
    const PoseEdge3d& step = map.steps[k - 1];
    message.step_from = static_cast<std::int32_t>(step.from);
    node::write_pose(step.T_from_to, message.step_position_m, message.step_orientation);
    node::write_matrix(step.information, message.step_information);
  }
  for (const Eigen::Vector3f& p : keyframe.cloud->points) {
    message.x_m.push_back(p.x());
    message.y_m.push_back(p.y());
    message.z_m.push_back(p.z());
  }
  message.num_points = static_cast<std::int32_t>(message.x_m.size());
  for (const SweepCloud::Line& line : keyframe.cloud->lines) {
    message.scan_end.push_back(static_cast<std::int32_t>(line.end));
    message.mirror_m.push_back(
        {line.p_base_mirror.x(), line.p_base_mirror.y(), line.p_base_mirror.z()});
  }
  message.num_scans = static_cast<std::int32_t>(message.scan_end.size());
  return message;
}

nodmap::loop_6d_t write_loop(const PoseEdge3d& loop) {
  nodmap::loop_6d_t message{};
  message.from_keyframe = static_cast<std::int32_t>(loop.from);
  message.to_keyframe = static_cast<std::int32_t>(loop.to);
  node::write_pose(loop.T_from_to, message.position_m, message.orientation);
  node::write_matrix(loop.information, message.information);
  return message;
}

// Builds a map from messages; throws if one of them cannot be part of it.
class Reader {
 public:
  explicit Reader(const bus::MessageLogReader& log) : log_(log) {}

  void add(const bus::LogEvent& event) {
    if (event.channel == kKeyframeChannel) {
      add_keyframe(log_.decode<nodmap::keyframe_6d_t>(event));
    } else if (event.channel == kLoopChannel) {
      add_loop(log_.decode<nodmap::loop_6d_t>(event));
    }
  }

  SavedMap finish() {
    require(!map_.keyframes.empty(), "no keyframe of 6D SLAM");
    for (const PoseEdge3d& loop : map_.loops) {
      require(loop.to < map_.keyframes.size(), "a loop to a keyframe that does not exist");
    }
    return std::move(map_);
  }

 private:
  void require(bool holds, const std::string& problem) const { log_.require(holds, problem); }

  [[nodiscard]] static bool is_near(const Eigen::Vector3f& p_base) {
    return p_base.cast<double>().norm() <= scan::kFarthestPointM;  // false for NaN
  }

  [[nodiscard]] std::string here() const {
    return "keyframe " + std::to_string(map_.keyframes.size());
  }

  [[nodiscard]] SE3 read_pose(const double (&position_m)[3], const double (&orientation)[4]) const {
    const auto pose = node::read_pose(position_m, orientation);
    require(pose.has_value(), here() + " holds an impossible pose");
    return *pose;
  }

  [[nodiscard]] Matrix6d read_information(const double (&in)[6][6]) const {
    Matrix6d information = node::read_matrix(in);
    require(registration::is_information(information),
            "an edge without a valid information matrix");
    return information;
  }

  void add_keyframe(const nodmap::keyframe_6d_t& message) {
    auto cloud = std::make_shared<SweepCloud>();
    cloud->stamp = node::stamp_of(message);
    cloud->points.reserve(message.x_m.size());
    for (std::size_t i = 0; i < message.x_m.size(); ++i) {
      cloud->points.emplace_back(message.x_m[i], message.y_m[i], message.z_m[i]);
      require(is_near(cloud->points.back()), here() + " holds an impossible point");
    }
    std::size_t begin = 0;
    for (std::size_t i = 0; i < message.scan_end.size(); ++i) {
      const auto end = static_cast<std::size_t>(message.scan_end[i]);
      require(message.scan_end[i] >= 0 && begin <= end && end <= cloud->points.size(),
              here() + " has scans that are not in order");
      const std::vector<float>& mirror = message.mirror_m[i];
      cloud->lines.push_back({Eigen::Vector3f(mirror[0], mirror[1], mirror[2]), end});
      require(is_near(cloud->lines.back().p_base_mirror), here() + " holds an impossible mirror");
      begin = end;
    }
    require(begin == cloud->points.size(), here() + " has points of no scan");
    if (!map_.keyframes.empty()) {
      add_step(message);
    }
    map_.keyframes.push_back({.cloud = std::move(cloud),
                              .T_map_base = read_pose(message.position_m, message.orientation),
                              .is_level = message.is_level != 0});
  }

  void add_step(const nodmap::keyframe_6d_t& message) {
    const std::size_t to = map_.keyframes.size();
    require(message.step_from >= 0 && static_cast<std::size_t>(message.step_from) < to,
            here() + " is joined to none before it");
    map_.steps.push_back({.from = static_cast<std::size_t>(message.step_from),
                          .to = to,
                          .T_from_to = read_pose(message.step_position_m, message.step_orientation),
                          .information = read_information(message.step_information)});
  }

  void add_loop(const nodmap::loop_6d_t& message) {
    require(message.from_keyframe >= 0 && message.to_keyframe >= 0 &&
                message.from_keyframe != message.to_keyframe,
            "a loop between impossible keyframes");
    const auto from = static_cast<std::size_t>(message.from_keyframe);
    require(from < map_.keyframes.size(), "a loop from a keyframe that does not exist");
    map_.loops.push_back({.from = from,
                          .to = static_cast<std::size_t>(message.to_keyframe),
                          .T_from_to = read_pose(message.position_m, message.orientation),
                          .information = read_information(message.information),
                          .may_be_wrong = true});
  }

  const bus::MessageLogReader& log_;
  SavedMap map_;
};

}  // namespace

std::error_code write_saved_map(const std::filesystem::path& dir, const SavedMap& map) {
  bus::MessageLogWriter writer(dir / kFileName);
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    writer.write(map.keyframes[k].cloud->stamp, kKeyframeChannel, write_keyframe(map, k));
  }
  for (const PoseEdge3d& loop : map.loops) {
    writer.write(map.keyframes.back().cloud->stamp, kLoopChannel, write_loop(loop));
  }
  return writer.replace();
}

SavedMap read_saved_map(const std::filesystem::path& path) {
  if (path.extension() == ".bt" || path.extension() == ".ot") {
    throw formats::InputFileError(path.string() +
                                  ": is an OctoMap, which contains no sweeps; the folder of a "
                                  "saved map, or the keyframes.lcmlog in it, is needed");
  }
  return bus::read_message_log<Reader>(path, kFileName);
}

}  // namespace nodmap::slam6d
