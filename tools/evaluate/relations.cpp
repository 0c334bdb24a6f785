// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/relations.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "common/formats/input_file.hpp"
#include "common/formats/stamp.hpp"
#include "common/formats/text_lines.hpp"

namespace nodmap::evaluate {
namespace {

std::optional<Relation> parse_relation(const std::string& line) {
  std::istringstream fields(line);
  std::string from;
  std::string to;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  double roll = 0.0;
  double pitch = 0.0;
  double yaw = 0.0;
  fields >> from >> to >> p.x() >> p.y() >> p.z() >> roll >> pitch >> yaw;
  const auto from_stamp = formats::parse_stamp(from);
  const auto to_stamp = formats::parse_stamp(to);
  if (!fields || !from_stamp || !to_stamp) {
    return std::nullopt;
  }
  const Eigen::Quaterniond q = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
  return Relation{*from_stamp, *to_stamp, geometry::make_se3(p, q)};
}

struct Moments {
  double mean = 0.0;
  double deviation = 0.0;
};

Moments moments(std::span<const double> values) {
  Moments result;
  if (values.empty()) {
    return result;
  }
  const auto n = static_cast<double>(values.size());
  for (const double value : values) {
    result.mean += value / n;
  }
  double variance = 0.0;
  for (const double value : values) {
    variance += (value - result.mean) * (value - result.mean) / n;
  }
  result.deviation = std::sqrt(variance);
  return result;
}

}  // namespace

std::vector<Relation> read_relations(const std::filesystem::path& file) {
  formats::TextLines lines(file);
  std::vector<Relation> relations;
  while (lines.next_content()) {
    const std::string line(lines.line());
    const auto relation = parse_relation(line);
    if (!relation) {
      throw formats::InputFileError(
          lines.place() + ": expected 't1 t2 x y z roll pitch yaw', found " + formats::quote(line));
    }
    relations.push_back(*relation);
  }
  return relations;
}

RelationErrors measure_relations(const formats::Trajectory& trajectory,
                                 std::span<const Relation> relations) {
  std::map<time::Timestamp, const geometry::SE3*> pose_at;
  for (const formats::StampedPose& stamped : trajectory) {
    pose_at.emplace(stamped.stamp, &stamped.pose);  // keeps the first
  }
  RelationErrors errors;
  std::vector<double> trans_m;
  std::vector<double> rot_rad;
  for (const Relation& relation : relations) {
    const auto from = pose_at.find(relation.from_stamp);
    const auto to = pose_at.find(relation.to_stamp);
    if (from == pose_at.end() || to == pose_at.end()) {
      ++errors.missing;
      continue;
    }
    const geometry::SE3 error =
        relation.T_from_to.inverse() * (from->second->inverse() * *to->second);
    trans_m.push_back(error.translation().norm());
    rot_rad.push_back(geometry::rotation_angle(error));
    errors.trans_max_m = std::max(errors.trans_max_m, trans_m.back());
  }
  errors.n = trans_m.size();
  const Moments trans = moments(trans_m);
  const Moments rot = moments(rot_rad);
  errors.trans_mean_m = trans.mean;
  errors.trans_std_m = trans.deviation;
  errors.rot_mean_rad = rot.mean;
  errors.rot_std_rad = rot.deviation;
  return errors;
}

}  // namespace nodmap::evaluate
