// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/first_sweeps.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {
namespace {

// With beams. 30 sweeps of 80 scans take 2 MB.
constexpr std::size_t kMaxWhole = 30;
// Without: two hours of standing, 30 MB.
constexpr std::size_t kMaxEmptied = 10'000;
// At one place. The pitch latency needs the first two.
constexpr std::size_t kMaxWholeAtPlace = 3;
constexpr double kSamePlaceM = 0.02;
constexpr double kSamePlaceRad = geometry::deg_to_rad(1.0);

// First and last scan, which say how long the sweep took and how the robot moved.
PlacedSweep without_beams(const PlacedSweep& sweep) {
  PlacedSweep emptied = sweep;
  emptied.scans.erase(
      emptied.scans.begin() + 1,
      emptied.scans.begin() + std::max<std::ptrdiff_t>(std::ssize(sweep.scans) - 1, 1));
  for (PlacedSweep::PlacedScan& placed : emptied.scans) {
    std::ranges::fill(placed.scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  }
  return emptied;
}

}  // namespace

void FirstSweeps::add(const PlacedSweep& sweep) {
  if (!are_kept_) {
    return;
  }
  const geometry::SE3 motion = T_odom_place_.inverse() * sweep.T_odom_base;
  if (sweeps_.empty() || motion.translation().norm() > kSamePlaceM ||
      geometry::rotation_angle(motion) > kSamePlaceRad) {
    T_odom_place_ = sweep.T_odom_base;
    num_at_place_ = 0;
  }
  ++num_at_place_;
  const bool is_emptied = num_at_place_ > kMaxWholeAtPlace;
  num_emptied_ += is_emptied ? 1 : 0;
  sweeps_.push_back(is_emptied ? without_beams(sweep) : sweep);
  if (sweeps_.size() - num_emptied_ > kMaxWhole || num_emptied_ > kMaxEmptied) {
    drop();
  }
}

void FirstSweeps::drop() {
  are_kept_ = false;
  sweeps_ = {};
  num_emptied_ = 0;
}

}  // namespace nodmap::slam6d
