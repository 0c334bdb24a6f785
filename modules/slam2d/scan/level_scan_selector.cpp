// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_selector.hpp"

#include <cmath>
#include <utility>

namespace nodmap::slam2d {
namespace {

// Less than the pitch step of the slowest nod (0.25 deg), more than the noise of an encoder.
constexpr double kConstantRad = geometry::deg_to_rad(0.05);

bool looks_up(const scan::Scan& scan) {
  return scan.pitch_mid_rad() >= 0.0;
}

}  // namespace

bool has_constant_pitch(const scan::Scan& scan) {
  return std::abs(scan.pitch_last_rad - scan.pitch_first_rad) <= kConstantRad;
}

bool LevelScanSelector::is_level(const scan::Scan& scan) const {
  return std::abs(scan.pitch_mid_rad()) <= params_.max_pitch_rad;
}

const scan::Scan* LevelScanSelector::add(const scan::Scan& scan) {
  std::swap(older_[1], older_[0]);
  std::swap(older_[0], previous_);
  std::swap(previous_, current_);
  current_ = scan;
  const bool previous_was_used = std::exchange(current_was_used_, false);
  const double last_pitch = previous_ ? previous_->pitch_mid_rad() : 0.0;
  is_held_ =
      has_constant_pitch(scan) && std::abs(scan.pitch_mid_rad() - last_pitch) <= kConstantRad;
  return select(is_held_, previous_was_used);
}

const scan::Scan* LevelScanSelector::select(bool is_held, bool previous_was_used) {
  if (is_held) {
    current_was_used_ = is_level(*current_);
    return current_was_used_ ? &*current_ : nullptr;
  }
  if (!previous_ || looks_up(*previous_) == looks_up(*current_)) {
    return nullptr;
  }
  const bool previous_is_nearer =
      std::abs(previous_->pitch_mid_rad()) <= std::abs(current_->pitch_mid_rad());
  const scan::Scan& nearest = previous_is_nearer ? *previous_ : *current_;
  if (!is_level(nearest) || (previous_is_nearer && previous_was_used)) {
    return nullptr;
  }
  current_was_used_ = !previous_is_nearer;
  return &nearest;
}

std::array<const scan::Scan*, 2> LevelScanSelector::before() const {
  const std::optional<scan::Scan>& last = current_was_used_ ? previous_ : older_[0];
  const std::optional<scan::Scan>& last_but_one = current_was_used_ ? older_[0] : older_[1];
  if (is_held_ || !last || !last_but_one) {
    return {nullptr, nullptr};
  }
  return {&*last, &*last_but_one};
}

}  // namespace nodmap::slam2d
