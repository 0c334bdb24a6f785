// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/bus/loop_bus.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "sim/plant.hpp"
#include "sim/ray_caster.hpp"
#include "tools/trial/brake_watch.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// Sees how things are, and hears what is said; tells TRUTH, to which no part of the robot listens.
class Witness {
 public:
  Witness(const sim::World& world, const sim::Plant& plant, bus::LoopNetwork& network,
          const StoppingWay& way);

  /// To be called every millisecond of simulated time.
  void look();

  [[nodiscard]] const TrialRecord& record() const { return record_; }
  [[nodiscard]] const BrakeWatch& brake() const { return brake_; }

 private:
  void subscribe();
  void on_pitch_state(const nodmap::pitch_state_t& message);
  void publish(const sim::Truth& truth);
  void watch_actors(const sim::Truth& truth);
  [[nodiscard]] bool is_visible(const sim::ActorState& actor, const sim::Truth& truth) const;

  sim::World world_;
  const sim::Plant& plant_;
  sim::RayCaster caster_;  // of what stands still
  bus::LoopBus bus_;
  BrakeWatch brake_;
  TrialRecord record_;
  std::optional<std::int64_t> sweep_;
  std::int64_t truth_seq_ = 0;
};

}  // namespace nodmap::trial
