// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/kurt.hpp"

#include <cmath>
#include <type_traits>
#include <utility>

namespace nodmap::kurt {
namespace {

// Number of implausible frames in a row that are bridged like lost ones (100 ms). A bit error
// damages one frame only; bridging ends well before kBlind.
constexpr int kBridgedInARow = 10;
static_assert(kBridgedInARow * kEncoderPeriod < kBlind);
// After a loss of the line the encoder clock must see a gap, in which the motion is unknown; it
// would bridge a shorter silence at the speed before the loss.
static_assert(SlcanSession::kSettle >= kBaseTimeout);

}  // namespace

Kurt::Kurt(const KurtParams& params)
    : odometry_(params.wheels, params.odometry, params.gyro),
      limiter_(params.wheels, params.limits),
      watchdog_(time::from_seconds(params.drive_timeout_s)),
      guard_(params.guard, params.limits) {}

void Kurt::connected(const time::Moment& now) {
  line_open_ = true;
  parser_.restart();
  session_.start(now.steady);
}

void Kurt::disconnected() {
  line_open_ = false;
  session_.stop();
  last_encoder_.reset();
  // After a loss the robot is stationary until a new DRIVE is received.
  watchdog_.revoke();
}

std::span<const OdometrySample> Kurt::receive(std::span<const std::uint8_t> bytes,
                                              const time::Moment& now) {
  motion_.clear();
  samples_.clear();
  std::int64_t waited = 0;
  parser_.push(bytes, [this, &now, &waited](const SlcanLine& line) {
    session_.take(line, now.steady);
    if (line.kind != SlcanLine::Kind::kFrame || !session_.is_open()) {
      return;
    }
    const Report report = decode(line.frame);
    if (const auto* ticks = std::get_if<EncoderTicks>(&report)) {
      motion_.emplace_back(*ticks);
      ++waited;
    } else {
      take_sensor(report, now.steady);
    }
  });
  // Frames received in one read were sent one period apart; all but the last have waited.
  for (const auto& measured : motion_) {
    if (const auto* ticks = std::get_if<EncoderTicks>(&measured)) {
      take_encoder(*ticks, now.steady - --waited * kEncoderPeriod, now);
    } else {
      odometry_.correct(std::get<Gyro>(measured));
    }
  }
  return samples_;
}

void Kurt::take_encoder(const EncoderTicks& ticks, time::SteadyTime arrival,
                        const time::Moment& now) {
  ++counts_.encoder_frames;
  guard_.add(ticks, limiter_.current(), arrival);
  if (!accept_ticks(ticks, arrival)) {
    odometry_.ignore(ticks);
    return;
  }
  if (session_.delay() > 0us) {
    odometry_.add(ticks);  // when they were measured is unknown: the pose is right, but no sample
    return;
  }
  const EncoderClock::Reading reading = encoder_clock_.take(arrival);
  if (reading.gap > 0us) {
    ++counts_.encoder_gaps;
    odometry_.bridge_gap(time::seconds(reading.gap));
  }
  if (reading.lost > 0) {
    counts_.encoder_lost += reading.lost;
    odometry_.bridge(reading.lost);
  }
  odometry_.add(ticks);  // bridges implausible ticks
  samples_.push_back({now.wall_at(reading.measured), odometry_.state()});
}

// Implausible ticks say nothing about the wheels, so they must not keep the robot driving. Too
// many in a row are ignored, and the robot stops as if the base were silent.
bool Kurt::accept_ticks(const EncoderTicks& ticks, time::SteadyTime arrival) {
  if (odometry_.is_plausible(ticks)) {
    last_encoder_ = arrival;
    implausible_in_a_row_ = 0;
    return true;
  }
  ++counts_.encoder_implausible;
  return last_encoder_ && ++implausible_in_a_row_ <= kBridgedInARow;
}

void Kurt::take_sensor(const Report& report, time::SteadyTime now) {
  std::visit(
      [this, now](const auto& value) {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, Bumpers>) {
          guard_.add(value);
        } else if constexpr (std::is_same_v<Value, RangeReadings>) {
          guard_.add(value, now);
          take_ranges(value, now);
        } else if constexpr (std::is_same_v<Value, Tilt>) {
          guard_.add(value, now);
          sensors_.tilt = {value, now};
        } else if constexpr (std::is_same_v<Value, Gyro>) {
          sensors_.gyro = {value, now};
          motion_.emplace_back(value);
        } else if constexpr (std::is_same_v<Value, MotorCurrents>) {
          sensors_.motor_currents = {value, now};
        }
      },
      report);
}

void Kurt::take_ranges(const RangeReadings& ranges, time::SteadyTime now) {
  for (std::size_t i = 0; i < kInfraredCount; ++i) {
    if (ranges.infrared_raw[i]) {
      sensors_.infrared_raw[i] = {*ranges.infrared_raw[i], now};
    }
  }
  if (ranges.sonar_raw) {
    sensors_.sonar_raw = {*ranges.sonar_raw, now};
  }
}

DriveStatus Kurt::drive(const DriveRequest& request, const time::Moment& now) {
  const DriveStatus status = watchdog_.offer(request, now.wall, now.steady);
  if (!watchdog_.command(now.steady)) {
    // At once, because the next DRIVE may be received before the next control().
    limiter_.stop();
  }
  return status;
}

std::optional<Alarm> Kurt::take_alarm() {
  const std::optional<Alarm> alarm = guard_.take_alarm();
  if (alarm) {
    watchdog_.revoke();
    limiter_.stop();
  }
  return alarm;
}

KurtState Kurt::state(time::SteadyTime steady) const {
  if (!line_open_) {
    return KurtState::kNoLine;
  }
  if (!session_.is_open()) {
    return KurtState::kNoBus;
  }
  if (!last_encoder_ || steady - *last_encoder_ >= kBlind) {
    return KurtState::kNoBase;
  }
  if (session_.delay() > 0us) {
    return KurtState::kLate;
  }
  return watchdog_.command(steady) ? KurtState::kDriving : KurtState::kNoDrive;
}

std::string Kurt::control(const time::Moment& now) {
  std::string text = session_.poll(now.steady);
  const KurtState state_now = state(now.steady);
  if (now.steady - std::exchange(last_control_, now.steady).value_or(now.steady) >= kBaseTimeout) {
    limiter_.start_from({odometry_.state().forward_mps, odometry_.state().yaw_rate_rad_s});
  }
  if (state_now == KurtState::kDriving) {
    limiter_.step(guard_.limit(*watchdog_.command(now.steady), now.steady),
                  time::seconds(kControlPeriod));
  } else {
    limiter_.stop();
  }
  if (session_.is_open()) {
    text += to_line(speed_command(limiter_.current()));
  }
  return text;
}

}  // namespace nodmap::kurt
