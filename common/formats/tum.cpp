// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/tum.hpp"

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "common/formats/atomic_file.hpp"
#include "common/formats/input_file.hpp"
#include "common/formats/stamp.hpp"
#include "common/formats/text_lines.hpp"

namespace nodmap::formats {

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& stamped : trajectory) {
    const Eigen::Vector3d& p = stamped.pose.translation();
    Eigen::Quaterniond q(stamped.pose.linear());
    if (q.w() < 0.0) {
      q.coeffs() = -q.coeffs();
    }
    const std::int64_t utime = time::to_utime(stamped.stamp);
    const std::int64_t magnitude = std::abs(utime);
    char line[256];
    const int length = std::snprintf(
        line, sizeof line, "%s%" PRId64 ".%06d %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
        utime < 0 ? "-" : "", magnitude / 1'000'000, static_cast<int>(magnitude % 1'000'000), p.x(),
        p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
    text.append(line, static_cast<std::size_t>(length));
  }
  write_file(file, text);
}

Trajectory read_tum(const std::filesystem::path& file) {
  TextLines lines(file);
  Trajectory trajectory;
  while (lines.next_content()) {
    const std::string line(lines.line());
    std::istringstream fields(line);
    std::string stamp_text;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    fields >> stamp_text >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w();
    const auto stamp = parse_stamp(stamp_text);
    if (!fields || !stamp || std::abs(q.norm() - 1.0) > 0.01) {
      throw InputFileError(lines.place() + ": expected 'timestamp x y z qx qy qz qw', found " +
                           quote(line));
    }
    trajectory.push_back({*stamp, geometry::make_se3(p, q.normalized())});
  }
  return trajectory;
}

}  // namespace nodmap::formats
