// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "common/node/node.hpp"
#include "drivers/laser3d/laser3d.hpp"
#include "drivers/serial/reconnecting_port.hpp"
#include "nodmap/pitch_command_t.hpp"

namespace nodmap::laser3d {

/// One moment on two clocks: stamps of messages are of the first, everything else is of the second,
/// which never steps.
struct Moment {
  std::int64_t utime_us = 0;
  std::int64_t steady_us = 0;
};

/// The shell of the 3D scanner: carries bytes between two ports and Laser3d, and messages between
/// Laser3d and bus. Its loop is outside: turn() whenever one of poll_handles() is readable, and at
/// least every kTurnUs.
class Laser3dNode : public node::Node {
 public:
  using Params = Laser3dParams;
  static constexpr std::int64_t kTurnUs = 2000;

  struct Openers {
    serial::ReconnectingPort::Opener laser;
    serial::ReconnectingPort::Opener servo;
  };

  Laser3dNode(node::Context& context, const Laser3dParams& params, Openers open,
              std::function<Moment()> clock);

  /// Takes in what has arrived, sends what is due. Waits for nothing but a port that does not take
  /// its bytes, and for that 50 ms.
  void turn();

  /// The descriptors of laser and servo; -1 while there is none.
  [[nodiscard]] std::array<int, 2> poll_handles();

  /// Ends the laser's stream, so that the next start is quick. To be turned on until at_rest().
  void shut_down();
  [[nodiscard]] bool at_rest() const { return driver_.laser_at_rest(); }

  void write_results(const std::filesystem::path& /*dir*/) override {}  // a driver leaves no files
  [[nodiscard]] nlohmann::json figures() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  struct Line {
    serial::ReconnectingPort port;
    bool connected = false;
    int baud = 0;
  };

  void attend(Line& line, const Moment& now);
  void lose(Line& line, const Moment& now, const std::string& reason);
  void carry_out(Laser3dOutput output, const Moment& now);
  void perform(Line& line, const LineAction& action, const Moment& now);
  void on_command(const nodmap::pitch_command_t& message);
  void publish(const PitchState& state, const Moment& now);
  void publish(scan::Scan scan, const Moment& now);
  void tell_change(const Moment& now);

  node::Context& context_;
  Laser3dParams params_;
  Laser3d driver_;
  Line laser_;
  Line servo_;
  std::function<Moment()> clock_;
  std::string told_;
  std::int64_t told_lost_ = 0;
  std::int64_t state_seq_ = 0;
};

}  // namespace nodmap::laser3d
