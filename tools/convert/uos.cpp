// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/uos.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/scan/scan.hpp"
#include "tools/convert/sick.hpp"

namespace nodmap::convert {
namespace {

using geometry::deg_to_rad;

// Smallest change of pitch between slices. A pitching SICK moves half a degree from slice to slice;
// the file has a resolution of 0.01.
constexpr double kSamePlaneRad = deg_to_rad(0.2);
// Beams closer to the pitch axis than this determine the pitch too poorly.
constexpr double kMinSineForPitch = 0.05;
// Points closer together than this are one beam; the finest step of a SICK is a quarter of a
// degree.
constexpr double kMinStepRad = deg_to_rad(0.1);

// A point as the scanner measured it.
struct Beam {
  double angle_rad = 0.0;  // in the plane; 0 ahead, positive to the left
  double range_m = 0.0;
  std::optional<double> pitch_rad;  // pitch of its plane through the axis, if it is defined
};

Beam to_beam(const Eigen::Vector3d& p_m) {
  const double across_m = std::hypot(p_m.x(), p_m.z());
  Beam beam;
  beam.range_m = p_m.norm();
  beam.angle_rad = std::atan2(p_m.y(), across_m);
  if (across_m > kMinSineForPitch * beam.range_m) {
    beam.pitch_rad = std::atan2(p_m.z(), p_m.x());
  }
  return beam;
}

// Rounds an angle to a multiple of `unit_deg`, which removes the last digits of a file.
double rounded_rad(double angle_rad, double unit_deg) {
  return deg_to_rad(unit_deg * std::round(geometry::rad_to_deg(angle_rad) / unit_deg));
}

// The step between neighbouring beams, negative if the mirror rotates to the right. The median is
// not affected by jumps between slices or missing beams.
double median_step_rad(std::span<const Beam> beams) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < beams.size(); ++i) {
    const double step_rad = beams[i].angle_rad - beams[i - 1].angle_rad;
    if (std::abs(step_rad) > kMinStepRad) {
      steps.push_back(step_rad);
    }
  }
  if (steps.empty()) {
    return 0.0;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  // Steps are multiples of a quarter of a degree, so the digits of the file do not matter.
  return rounded_rad(*middle, 0.25);
}

// The fan that all slices share.
struct Fan {
  double first_rad = 0.0;
  double step_rad = 0.0;
  std::size_t num_beams = 0;

  [[nodiscard]] std::size_t index(double angle_rad) const {
    const auto beam =
        static_cast<std::size_t>(std::max(0L, std::lround((angle_rad - first_rad) / step_rad)));
    return std::min(beam, num_beams - 1);
  }
};

Fan find_fan(std::span<const Beam> beams) {
  Fan fan;
  fan.step_rad = median_step_rad(beams);
  if (fan.step_rad == 0.0) {
    return fan;
  }
  const auto [least, most] = std::ranges::minmax_element(beams, {}, &Beam::angle_rad);
  fan.first_rad = rounded_rad((fan.step_rad > 0.0 ? least : most)->angle_rad, 0.01);
  const double span_rad = most->angle_rad - least->angle_rad;
  fan.num_beams = static_cast<std::size_t>(std::lround(span_rad / std::abs(fan.step_rad))) + 1;
  return fan;
}

// How far the scanner measures; farther ranges mean "no echo". A single absurd point does not make
// the scan one that no program takes.
double find_range_max_m(std::span<const Beam> beams) {
  const double farthest_m = std::ranges::max_element(beams, {}, &Beam::range_m)->range_m;
  return farthest_m > kSickIndoorLargestM
             ? std::min(std::nextafter(farthest_m, 2.0 * farthest_m), scan::kFarthestRangeM)
             : kSickIndoorRangeMaxM;
}

// The slice being filled.
class SliceBuilder {
 public:
  SliceBuilder(const Fan& fan, double range_max_m) : fan_(fan) { slice_.range_max_m = range_max_m; }

  [[nodiscard]] bool continues_with(const Beam& beam) const {
    const bool turns_on =
        !last_angle_rad_ || (beam.angle_rad - *last_angle_rad_) / fan_.step_rad > 0.5;
    const bool same_plane =
        !pitch_rad_ || !beam.pitch_rad || std::abs(*beam.pitch_rad - *pitch_rad_) < kSamePlaneRad;
    return turns_on && same_plane;
  }

  void add(const Beam& beam) {
    if (slice_.ranges_m.empty()) {
      slice_.ranges_m.assign(fan_.num_beams, std::numeric_limits<float>::quiet_NaN());
    }
    const bool returned = beam.range_m < slice_.range_max_m;
    slice_.ranges_m[fan_.index(beam.angle_rad)] =
        returned ? static_cast<float>(beam.range_m) : std::numeric_limits<float>::infinity();
    last_angle_rad_ = beam.angle_rad;
    if (beam.pitch_rad) {
      pitch_sum_rad_ += *beam.pitch_rad;
      pitch_rad_ = pitch_sum_rad_ / ++num_pitches_;
    }
  }

  // The completed slice, if its pitch is known.
  [[nodiscard]] std::optional<UosSlice> finish() && {
    if (!pitch_rad_) {
      return std::nullopt;
    }
    slice_.pitch_rad = *pitch_rad_;
    slice_.angle_first_rad = fan_.first_rad;
    slice_.angle_step_rad = fan_.step_rad;
    return std::move(slice_);
  }

 private:
  Fan fan_;
  UosSlice slice_;
  std::optional<double> last_angle_rad_;
  std::optional<double> pitch_rad_;
  double pitch_sum_rad_ = 0.0;
  int num_pitches_ = 0;
};

// Rotates a vector of the file into our axes.
Eigen::Matrix3d ours_from_uos() {
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1, -1, 0, 0, 0, 1, 0;
  return rotation;
}

}  // namespace

Eigen::Vector3d from_uos(const Eigen::Vector3d& p_uos_cm) {
  return 0.01 * (ours_from_uos() * p_uos_cm);
}

Eigen::Vector3d to_uos(const Eigen::Vector3d& p_m) {
  return 100.0 * (ours_from_uos().transpose() * p_m);
}

UosPose to_uos_pose(const geometry::SE3& pose) {
  const Eigen::Matrix3d R = ours_from_uos().transpose() * pose.linear() * ours_from_uos();
  const Eigen::Vector3d euler_rad(std::atan2(-R(1, 2), R(2, 2)),
                                  std::asin(std::clamp(R(0, 2), -1.0, 1.0)),
                                  std::atan2(-R(0, 1), R(0, 0)));
  return {to_uos(pose.translation()), euler_rad / deg_to_rad(1.0)};
}

geometry::SE3 from_uos_pose(const Eigen::Vector3d& position_cm, const Eigen::Vector3d& euler_deg) {
  const Eigen::Vector3d e = euler_deg * deg_to_rad(1.0);
  // In 3DTK's frame the matrix is Rx(x) Ry(y) Rz(z), each written for right-handed axes.
  const Eigen::Matrix3d R_uos = (Eigen::AngleAxisd(e.x(), Eigen::Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(e.y(), Eigen::Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(e.z(), Eigen::Vector3d::UnitZ()))
                                    .toRotationMatrix();
  geometry::SE3 pose = geometry::SE3::Identity();
  pose.linear() = ours_from_uos() * R_uos * ours_from_uos().transpose();
  pose.translation() = from_uos(position_cm);
  return pose;
}

std::vector<UosSlice> find_slices(std::span<const Eigen::Vector3d> points_m) {
  std::vector<Beam> beams;
  beams.reserve(points_m.size());
  for (const Eigen::Vector3d& p_m : points_m) {
    if (p_m.allFinite() && p_m.squaredNorm() > 0.0) {
      beams.push_back(to_beam(p_m));
    }
  }
  const Fan fan = find_fan(beams);
  std::vector<UosSlice> slices;
  if (fan.num_beams < 2) {
    return slices;
  }
  const SliceBuilder empty(fan, find_range_max_m(beams));
  SliceBuilder builder = empty;
  const auto finish_slice = [&] {
    if (auto slice = std::exchange(builder, empty).finish()) {
      slices.push_back(std::move(*slice));
    }
  };
  for (const Beam& beam : beams) {
    if (!builder.continues_with(beam)) {
      finish_slice();
    }
    builder.add(beam);
  }
  finish_slice();
  return slices;
}

}  // namespace nodmap::convert
