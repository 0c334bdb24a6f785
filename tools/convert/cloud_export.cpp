// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/cloud_export.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/drawing/image.hpp"
#include "common/formats/cloud_file.hpp"
#include "common/formats/tum.hpp"
#include "common/formats/user_error.hpp"
#include "common/geometry/pose_history.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "common/scan/scan.hpp"
#include "tools/convert/log_events.hpp"
#include "tools/convert/new_file.hpp"

namespace nodmap::convert {
namespace {

struct SensorLog {
  std::vector<scan::Scan> scans;  // of the window
  // Keeps all odometry, because the window may be anywhere.
  geometry::PoseHistory odometry{time::kLimit};
};

// Collects the scans of a window.
class WindowScans {
 public:
  WindowScans(const CloudWindow& window, std::vector<scan::Scan>& scans)
      : window_(window), scans_(scans) {}

  void add(scan::Scan scan) {
    start_ = start_.value_or(scan.stamp + time::from_seconds(window_.start_s));
    if (scan.stamp >= *start_ && scans_.size() < window_.num_scans) {
      scans_.push_back(std::move(scan));
    }
  }
  [[nodiscard]] bool is_log_empty() const { return !start_; }

 private:
  CloudWindow window_;
  std::vector<scan::Scan>& scans_;
  std::optional<time::Timestamp> start_;
};

SensorLog read_sensors(const std::filesystem::path& log, const CloudWindow& window) {
  SensorLog recording;
  WindowScans scans(window, recording.scans);
  nodmap::scan_t scan_message{};
  nodmap::odometry_t odometry_message{};
  for_each_event(log, [&](const bus::LogEvent& event) {
    scan::Scan scan;
    if (event.channel == "SCAN" && bus::decode_into(scan_message, event.data) &&
        node::read_scan(scan_message, scan)) {
      scans.add(std::move(scan));
    } else if (event.channel == "ODOMETRY" && bus::decode_into(odometry_message, event.data)) {
      if (const auto T_odom_base = node::read_odometry(odometry_message)) {
        recording.odometry.add(node::stamp_of(odometry_message), *T_odom_base);
      }
    }
  });
  if (scans.is_log_empty()) {
    throw formats::UserError(log.string() + ": contains no scan");
  }
  if (recording.scans.size() < window.num_scans) {
    throw formats::UserError(log.string() + ": has only " + std::to_string(recording.scans.size()) +
                             " scans after the requested start");
  }
  return recording;
}

struct Deskewed {
  std::vector<Eigen::Vector3f> points;
  std::size_t scans_without_odometry = 0;  // left out
};

// The points of all beams, each placed with the robot's pose at its own time, relative to the base
// pose in the middle of the window.
Deskewed deskew(std::span<const scan::Scan> scans, const geometry::PoseHistory& odometry,
                const geometry::SE3& T_base_odom) {
  constexpr double kRobotItselfM = 0.5;
  Deskewed deskewed;
  scan::ScanProjector projector;
  for (const scan::Scan& scan : scans) {
    const auto T_odom_first = odometry.at(scan.stamp);
    const auto T_odom_last = odometry.at(scan.last_stamp());
    if (!T_odom_first || !T_odom_last) {
      ++deskewed.scans_without_odometry;
      continue;
    }
    for (const auto& hit : projector.hits(scan)) {
      if (static_cast<double>(scan.ranges_m[hit.beam]) >= kRobotItselfM) {
        const geometry::SE3 T_odom_beam =
            geometry::interpolate(*T_odom_first, *T_odom_last, scan.fraction(hit.beam));
        deskewed.points.emplace_back((T_base_odom * T_odom_beam * hit.p_base).cast<float>());
      }
    }
  }
  return deskewed;
}

std::vector<formats::CloudPoint> colour_by_height(const std::vector<Eigen::Vector3f>& points,
                                                  time::Timestamp stamp) {
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  for (const Eigen::Vector3f& p : points) {
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  std::vector<formats::CloudPoint> coloured;
  coloured.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    const float place = high > low ? (p.z() - low) / (high - low) : 0.5F;
    coloured.push_back({.p = p,
                        .rgb = drawing::colour_scale(static_cast<double>(place)),
                        .time_s = time::seconds(stamp.time_since_epoch())});
  }
  return coloured;
}

}  // namespace

void export_cloud(const std::filesystem::path& log, const std::filesystem::path& out,
                  formats::CloudFormat format, const CloudWindow& window) {
  NewFile cloud_file(out);
  NewFile pose_file(std::filesystem::path(out).replace_extension(".tum"),
                    "the time and pose of " + out.string());
  const SensorLog recording = read_sensors(log, window);
  const std::vector<scan::Scan>& scans = recording.scans;
  const time::Timestamp begin = scans.front().stamp;
  const time::Timestamp middle = begin + (scans.back().last_stamp() - begin) / 2;
  const auto T_odom_base = recording.odometry.at(middle);
  if (!T_odom_base) {
    throw formats::UserError(log.string() + ": no odometry at the time of the scans");
  }
  const auto [points, num_left_out] = deskew(scans, recording.odometry, T_odom_base->inverse());
  if (points.empty()) {
    throw formats::UserError(log.string() + ": no points in the scans");
  }
  formats::write_cloud(cloud_file.partial_path(), format, colour_by_height(points, middle));
  formats::write_tum(pose_file.partial_path(), {{middle, *T_odom_base}});
  cloud_file.commit();
  pose_file.commit();
  if (num_left_out > 0) {
    log::get().warn("{} of {} scans left out: no odometry at their time", num_left_out,
                    scans.size());
  }
  log::get().info("{} points of {} scans", points.size(), scans.size() - num_left_out);
}

}  // namespace nodmap::convert
