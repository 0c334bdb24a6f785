// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"
#include "common/node/device_node.hpp"
#include "common/node/loss_meter.hpp"
#include "common/node/stop_latch.hpp"
#include "drivers/kurt/kurt.hpp"
#include "drivers/kurt/params.hpp"
#include "drivers/kurt/stop_repeater.hpp"
#include "drivers/serial/serial_link.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::kurt {

/// The node of the KURT2 driver: transports bytes between the serial line and Kurt, and messages
/// between Kurt and the bus.
class KurtNode final : public node::DeviceNode {
 public:
  using Params = KurtParams;

  KurtNode(node::Context& context, const KurtParams& params, serial::SerialLink::Opener open,
           std::function<time::Moment()> clock);
  /// Stops the robot, however the process ends.
  ~KurtNode() override;

  /// From now on refuses releases, for one second. The copies of a release arrive for 0.6 s. If it
  /// was given before this process was started, to one that has crashed since, it is not for this
  /// start, which nobody has seen. For a process that was started by itself.
  void refuse_former_releases();

  /// Reads what has arrived and, when it is due, sends a command to the base. Blocks only if the
  /// port does not accept bytes, for at most 5 ms.
  void spin_once() override;

  [[nodiscard]] std::array<int, 2> poll_handles() override;
  [[nodiscard]] time::Duration wait() const override;

  /// Switches the motors off and closes the port.
  void finish() override;

  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  /// What is missing in this state; empty if nothing is.
  [[nodiscard]] const char* lack(KurtState state) const;
  /// Why it works worse than it should although nothing keeps it from driving; empty if it does
  /// not.
  [[nodiscard]] std::string shortcoming() const;
  void receive(std::span<const std::uint8_t> bytes, const time::Moment& now);
  void send(const time::Moment& now);
  void on_drive(const nodmap::drive_t& message);
  void on_stop(const nodmap::stop_t& message);
  void stop_on_new_driver(const bus::Sender& sender);
  void publish_odometry(const OdometrySample& sample);
  void publish_sensors(const time::Moment& now);
  /// Stops the robot if the base's own sensors demand it.
  void stop_on_alarm();
  /// Stops the robot if its base is back after a long absence.
  void stop_on_return(const time::Moment& now);
  void count_losses(const time::Moment& now);
  void log_change(const time::Moment& now);

  node::Context& context_;
  Kurt kurt_;
  serial::SerialLink link_;
  std::function<time::Moment()> clock_;
  node::StopLatch stop_latch_;
  time::SteadyTime releases_count_from_;
  std::optional<bus::Sender> driver_;  // whose DRIVE has been obeyed since the release
  StopRepeater stop_repeater_;
  std::int64_t reported_lost_ = 0;
  node::LossMeter encoder_loss_;
  time::SteadyTime base_seen_;
  KurtState logged_state_ = KurtState::kNoLine;
  std::string_view logged_text_;
  bool is_lack_of_flags_logged_ = false;
  time::SteadyTime next_control_;
  time::SteadyTime next_sensors_;
  std::int64_t odometry_seq_ = 0;
  std::int64_t sensors_seq_ = 0;
};

}  // namespace nodmap::kurt
