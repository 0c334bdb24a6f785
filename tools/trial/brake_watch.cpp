// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/brake_watch.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::trial {
namespace {

/// Whether a disc touches the rectangle x in [0, length] from the front, |y| <= half_width.
bool touches(const sim::ActorState& actor, const geometry::SE2& T_world_base, double front_m,
             double length_m, double half_width_m) {
  const Eigen::Vector2d p = T_world_base.inverse() * actor.position;
  const double dx = p.x() - std::clamp(p.x(), front_m, front_m + length_m);
  const double dy = p.y() - std::clamp(p.y(), -half_width_m, half_width_m);
  return std::hypot(dx, dy) <= actor.radius_m;
}

bool brakes(double drive_mps, double speed_mps) {
  return drive_mps <= speed_mps - std::max(0.1, 0.1 * speed_mps);
}

}  // namespace

double StoppingWay::length_m(double forward_mps, double sweep_s) const {
  const double v = std::max(0.0, forward_mps);
  return v * (2.0 * sweep_s + processing_s) + v * v / (2.0 * deceleration_mps2) + margin_m;
}

void BrakeWatch::see(const Moment& moment) {
  actors_.resize(moment.visible.size());
  const double length_m = way_.length_m(moment.forward_mps, moment.sweep_s);
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    Watched& watched = actors_[i];
    const auto& actor = moment.visible[i];
    const bool now = actor && touches(*actor, moment.T_world_base, 0.5 * way_.body_length_m,
                                      length_m, 0.5 * way_.body_width_m);
    if (now && !watched.in_the_way && moment.forward_mps >= kSlowestMps) {
      watched.open = BrakeEvent{moment.time_us, moment.forward_mps, moment.sweep_s, std::nullopt};
    } else if (!now && watched.open) {
      ++evaded_;
      watched.open.reset();
    }
    watched.in_the_way = now;
  }
}

void BrakeWatch::hear_drive(std::int64_t time_us, double forward_mps) {
  for (Watched& watched : actors_) {
    if (watched.open && time_us > watched.open->began_us &&
        brakes(forward_mps, watched.open->speed_mps)) {
      watched.open->answered_us = time_us;
      answered_.push_back(*watched.open);
      watched.open.reset();
    }
  }
}

std::vector<BrakeEvent> BrakeWatch::events() const {
  std::vector<BrakeEvent> events = answered_;
  std::stable_sort(events.begin(), events.end(), [](const BrakeEvent& a, const BrakeEvent& b) {
    return a.began_us < b.began_us;
  });
  for (const Watched& watched : actors_) {
    if (watched.open) {
      events.push_back(*watched.open);
    }
  }
  return events;
}

}  // namespace nodmap::trial
