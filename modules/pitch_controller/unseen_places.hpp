// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// The places where an obstacle may have appeared without having been measured yet: for each recent
/// moment the protected distance of that moment, from which on the robot stops for whatever
/// appears. They come nearer as the robot drives. Metres ahead of the front.
class UnseenPlaces {
 public:
  /// Since the last call the robot has driven `moved_m`, and the head has turned by `turned_rad`,
  /// up and down.
  void advance(double moved_m, double turned_rad);
  /// Adds the place that is `protected_m` ahead now.
  void add(double protected_m);

  /// Forgets the places that the laser has measured in the meantime, as it passes within
  /// `revisit_s` what it has just passed.
  void forget_measured(const NodMotion& nod, double revisit_s);

  /// Where the nearest of these obstacles is when the laser measures it, if the robot drives at
  /// `forward_mps` until then; +infinity without such places.
  [[nodiscard]] double nearest_hit_m(const NodMotion& nod, double revisit_s,
                                     double forward_mps) const;
  /// The least protected distance among these places; +infinity without such places.
  [[nodiscard]] double least_protected_m() const;

 private:
  struct Place {
    double distance_m = 0.0;   // now
    double protected_m = 0.0;  // when it was added
    double turned_rad = 0.0;   // by the head since then

    [[nodiscard]] double measured_after_s(const NodMotion& nod, double revisit_s) const {
      return revisit_s - turned_rad / nod.rate_rad_s;
    }
  };
  std::vector<Place> places_;
};

}  // namespace nodmap::pitch_controller
