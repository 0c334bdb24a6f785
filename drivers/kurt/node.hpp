// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/geometry/time.hpp"
#include "common/node/device_node.hpp"
#include "drivers/kurt/kurt.hpp"
#include "drivers/kurt/params.hpp"
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
  /// What tells a STOP or release from others, and is the same when it is sent again.
  struct StopName {
    std::int64_t utime;
    std::string by;

    bool operator==(const StopName&) const = default;
  };

  void receive(std::span<const std::uint8_t> bytes, const time::Moment& now);
  void send(const time::Moment& now);
  void on_drive(const nodmap::drive_t& message);
  void on_stop(const nodmap::stop_t& message);
  void publish_odometry(const OdometrySample& sample);
  void publish_sensors(const time::Moment& now);
  /// Stops the robot if the base's own sensors demand it.
  void stop_on_alarm();
  /// Publishes STOP once a second while the robot is stopped, for processes that start later.
  void repeat_stop(const time::Moment& now);
  void log_change(const time::Moment& now);

  node::Context& context_;
  Kurt kurt_;
  serial::SerialLink link_;
  std::function<time::Moment()> clock_;
  /// Who stopped the robot; empty: it may drive. The driver starts in the stopped state.
  std::optional<std::string> stopped_by_;
  std::optional<time::SteadyTime> next_stop_;
  std::int64_t stop_seq_ = 0;
  std::optional<StopName> repeated_;  // the last STOP that this driver published
  /// The last releases that were obeyed. Copies of one arrive within a second, and nobody releases
  /// the robot this often in that time.
  boost::circular_buffer<StopName> releases_{16};
  std::int64_t reported_lost_ = 0;
  KurtState logged_state_ = KurtState::kNoLine;
  time::SteadyTime next_control_;
  time::SteadyTime next_sensors_;
  std::int64_t odometry_seq_ = 0;
  std::int64_t sensors_seq_ = 0;
};

}  // namespace nodmap::kurt
