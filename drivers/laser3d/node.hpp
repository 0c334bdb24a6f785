// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/bus/sender_watch.hpp"
#include "common/geometry/time.hpp"
#include "common/node/device_node.hpp"
#include "drivers/laser3d/laser3d.hpp"
#include "drivers/serial/serial_link.hpp"
#include "nodmap/pitch_command_t.hpp"

namespace nodmap::laser3d {

/// The node of the 3D scanner: transports bytes between two serial lines and Laser3d, and messages
/// between Laser3d and the bus.
class Laser3dNode final : public node::DeviceNode {
 public:
  using Params = Laser3dParams;
  static constexpr time::Duration kPollPeriod = 2ms;

  struct Openers {
    serial::SerialLink::Opener laser;
    serial::SerialLink::Opener servo;
  };

  Laser3dNode(node::Context& context, const Laser3dParams& params, Openers open,
              std::function<time::Moment()> clock);

  /// Reads what has arrived and sends what is due. Blocks only if a port does not accept bytes, for
  /// at most 50 ms.
  void spin_once() override;

  [[nodiscard]] std::array<int, 2> poll_handles() override;
  /// The sessions with laser and servo need regular calls for their timeouts.
  [[nodiscard]] time::Duration wait() const override { return kPollPeriod; }

  /// Ends the laser's stream, which makes the next start quick.
  void shut_down() override;
  [[nodiscard]] bool is_shut_down() const override { return driver_.is_laser_at_rest(); }

  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void carry_out(Laser3dOutput output, const time::Moment& now);
  void perform(serial::SerialLink& link, const LineAction& action, const time::Moment& now);
  void on_command(const nodmap::pitch_command_t& message);
  void publish(const PitchState& state, const time::Moment& now);
  void publish(SteadyScan scan, const time::Moment& now);
  void log_change(const time::Moment& now);

  node::Context& context_;
  Laser3dParams params_;
  Laser3d driver_;
  serial::SerialLink laser_;
  serial::SerialLink servo_;
  bus::SenderWatch sender_;
  int laser_baud_;
  std::function<time::Moment()> clock_;
  std::string logged_;
  std::int64_t reported_lost_ = 0;
  std::int64_t state_seq_ = 0;
};

}  // namespace nodmap::laser3d
