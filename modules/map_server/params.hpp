// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::map_server {

/// The angle bins of a map (paper, III B).
struct BinParams {
  double aperture_rad = geometry::deg_to_rad(360.0);
  double resolution_rad = geometry::deg_to_rad(1.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("aperture_deg", aperture_rad, {1.0, 360.0},
            "Aperture of both maps, centred ahead (paper, III B).");
    v.angle("resolution_deg", resolution_rad, {0.1, 10.0}, "Width of a bin.");
  }
};

struct NoiseParams {
  double range_sigma_m = 0.01;
  double pitch_sigma_rad = geometry::deg_to_rad(0.1);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("range_sigma_m", range_sigma_m, {0.0, 0.5},
             "Standard deviation of a range measurement.");
    v.angle("pitch_sigma_deg", pitch_sigma_rad, {0.0, 5.0},
            "Standard deviation of the pitch: raises the floor tolerance with distance, and how "
            "far the "
            "head must turn back to have reversed.");
  }
};

/// How stored points are removed: `kPaper` by age, as in the paper; `kVisibility` when beams pass
/// through them.
enum class RemovalRule : std::uint8_t { kPaper, kVisibility };

struct UpdateParams {
  RemovalRule rule = RemovalRule::kVisibility;
  double expiry_s = 5.0;
  double height_tolerance_m = 0.02;
  int misses_to_remove = 2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("rule", rule,
             {{"paper", RemovalRule::kPaper}, {"visibility", RemovalRule::kVisibility}},
             "How stored points are removed: by age as in the paper, or when beams pass through "
             "them.");
    v.number(
        "expiry_s", expiry_s, {0.1, 600.0},
        "Age at which a point is removed. paper: counts the time in motion; visibility: counts "
        "the time in full view without a new measurement.");
    v.number("height_tolerance_m", height_tolerance_m, {0.0, 0.5},
             "Heights that differ by less than this belong to the same part of an object "
             "(visibility only).");
    v.integer("misses_to_remove", misses_to_remove, {1, 100},
              "A point is removed when beams have passed through it in this many sweeps since its "
              "last measurement (visibility only).");
  }
};

struct MapServerParams {
  BinParams bins;
  robot::RobotParams robot;
  double base_height_m = 0.0;
  NoiseParams noise;
  UpdateParams update;
  bool assume_stationary = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("bins", bins);
    robot.describe(v);
    v.number("base_height_m", base_height_m, {-0.5, 5.0},
             "Height of the base frame above the ground; 0 unless the base of a recording is the "
             "scanner.");
    v.section("noise", noise);
    v.section("update", update);
    v.flag("assume_stationary", assume_stationary,
           "Treat the robot as stationary: for recordings without odometry.");
    describe_former_names(v);
  }

 private:
  template <class Visitor>
  static void describe_former_names(Visitor& v) {
    for (const char* name : {"aperture_deg", "resolution_deg"}) {
      v.renamed(name, std::string("bins.") + name);
    }
    for (const char* name : {"range_sigma_m", "pitch_sigma_deg"}) {
      v.renamed(name, std::string("noise.") + name);
    }
    for (const char* name : {"expiry_s", "height_tolerance_m", "misses_to_remove"}) {
      v.renamed(name, std::string("update.") + name);
    }
    v.renamed("update_rule", "update.rule");
    v.renamed("assume_standing", "assume_stationary");
  }
};

}  // namespace nodmap::map_server
