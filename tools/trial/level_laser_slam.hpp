// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/bus/loop_bus.hpp"
#include "common/geometry/pose_history.hpp"
#include "modules/slam2d/node.hpp"
#include "nodmap/scan_t.hpp"
#include "sim/body/rangefinder.hpp"
#include "sim/world/ray_caster.hpp"
#include "tools/trial/robot_software.hpp"

namespace nodmap::trial {

/// A second 2D SLAM on the same drive: the same program with the same parameters and ODOMETRY, but
/// with each SCAN replaced by what the same laser, mounted level, would have measured, beam by beam
/// from the true poses. It deskews and stamps its scans exactly as the first one does, so a
/// comparison shows the cost of nodding.
class LevelLaserSlam : private boost::noncopyable {
 public:
  /// Subscribes on `network`; its own messages go into the event log `log`. `T_world_base`: true
  /// poses by message time, kept up to date by its owner.
  LevelLaserSlam(const sim::World& world, const AllParams& params, std::uint64_t seed,
                 const geometry::PoseHistory& T_world_base, bus::LoopNetwork& network,
                 const std::filesystem::path& log);

  /// Ends the SLAM and writes its results.
  void finish(const std::filesystem::path& dir);

 private:
  void forward_scan(const nodmap::scan_t& message);
  [[nodiscard]] std::vector<sim::ActorState> actors_at(time::Timestamp stamp) const;

  sim::World world_;
  sim::RayCaster caster_;
  sim::Rangefinder rangefinder_;
  const geometry::PoseHistory& T_world_base_;
  bus::LoopBus input_;
  bus::LoopNetwork network_;
  bus::LoopBus output_;
  Process slam_;
};

}  // namespace nodmap::trial
