// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/contact/leave_contact.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/people_tracker.hpp"
#include "modules/navigator/people/proximity.hpp"
#include "modules/navigator/reason.hpp"
#include "modules/navigator/situation.hpp"
#include "modules/navigator/surroundings/approach.hpp"
#include "modules/navigator/surroundings/rear_view.hpp"
#include "modules/navigator/surroundings/scan_gap.hpp"
#include "modules/navigator/surroundings/seen_directions.hpp"

namespace nodmap::navigator {

/// What the navigator knows of the robot's surroundings: the local map, the people who walk, what
/// approaches, and which directions the laser has seen. From a Situation that has only the obstacle
/// map it makes one that has all of these, before the navigator decides.
class Surroundings {
 public:
  explicit Surroundings(const NavigatorParams& params);

  /// Adds a scan to the local map and to the tracks of people. `T_odom_base`: at the middle of the
  /// scan. `laser_is_held`: the laser does not nod.
  void add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base, bool laser_is_held);

  /// Adds something that the robot has touched, but that no beam shows; see
  /// LocalMap::add_contact(). After begin_anew() with the next scan.
  void add_contact(const Contact& contact_odom);

  /// Forgets all that has a place in odom, because the wheels have slipped; what is measured behind
  /// the robot stays.
  void begin_anew();

  /// Adds readings of the base's range finders; `T_odom_base` is the pose at `stamp`.
  void add_ranges(time::Timestamp stamp, const Proximity::Ranges& ranges_m,
                  const geometry::SE2& T_odom_base);

  /// Forgets which directions were seen.
  void forget_seen();
  /// For a gap in the scans that is shorter than a sweep: forgets only the directions that had not
  /// been seen long enough before it; at a second gap soon after, all of them.
  void miss_scans();

  /// Completes a situation that contains the points of the obstacle map: removes those that are
  /// ground or people, and adds people, the local map's obstacles and the geofence.
  void complete(Situation& now);

  /// Adds the people of whom it is not certain yet that they walk.
  void add_newcomers(Situation& now) const;

  /// Why the robot must wait: something approaches, or somebody is close.
  [[nodiscard]] std::optional<Reason> reason_to_wait(time::Timestamp stamp) const;

  /// Has no scan if the robot does not drive by it.
  [[nodiscard]] const LocalMap& local_map() const { return local_map_; }
  [[nodiscard]] const PeopleTracker& people() const { return people_; }

 private:
  void slow_down(Situation& now);
  void erase_floor(Situation& now);
  void erase_people(Situation& now);
  void watch_approach(const Situation& now, const Points& points_base);
  void add_local_map(Situation& now) const;
  void add_standing(Situation& now) const;
  void add_geofence(Situation& now) const;
  [[nodiscard]] double longest_stop_m() const;

  NavigatorParams params_;
  robot::Footprint body_;
  LocalMap local_map_;
  PeopleTracker people_;
  Proximity proximity_;
  RearView rear_view_;
  SeenDirections seen_;
  Approach approach_;
  ScanGap gap_;
  std::vector<Contact> new_contacts_odom_;  // for the local map
  std::optional<time::Timestamp> saw_people_at_;
};

}  // namespace nodmap::navigator
