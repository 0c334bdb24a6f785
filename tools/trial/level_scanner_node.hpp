// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "common/geometry/time.hpp"
#include "common/node/device_node.hpp"
#include "common/robot/robot_params.hpp"
#include "sim/body/robot_model.hpp"

namespace nodmap::trial {

/// A laser held level, which replaces the 3D scanner's driver: publishes SCAN, and PITCH_STATE with
/// a pitch of 0, 40 times a second. The beams of a scan are measured one after the other.
class LevelScannerNode final : public node::DeviceNode {
 public:
  static constexpr time::Duration kScanPeriod = 25ms;
  static constexpr double kRangeMaxM = 30.0;

  LevelScannerNode(node::Context& context, const robot::Mount& mount, sim::RobotModel& model);

  void spin_once() override;
  [[nodiscard]] std::array<int, 2> poll_handles() override { return {-1, -1}; }
  [[nodiscard]] time::Duration wait() const override { return {}; }
  [[nodiscard]] nlohmann::json metrics() const override;

 private:
  void publish_scan(time::SteadyTime end);
  void publish_pitch(time::SteadyTime now);

  node::Context& context_;
  robot::Mount mount_;
  sim::RobotModel& model_;
  time::SteadyTime next_scan_;
  std::int64_t seq_ = 0;
};

}  // namespace nodmap::trial
