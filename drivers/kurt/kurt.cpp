// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/kurt.hpp"

#include <cmath>
#include <type_traits>

namespace nodmap::kurt {
namespace {

constexpr double kControlPeriodS = 0.01;
/// Without encoders for so long nobody knows what the wheels do, and the robot stops.
constexpr std::int64_t kBlindUs = 200'000;
/// A bit error spoils one frame. So many in a row (100 ms) are bridged like lost ones, which ends
/// well before the robot stops for lack of encoders.
constexpr int kBridgedInARow = 10;
static_assert(kBridgedInARow * kEncoderPeriodUs < kBlindUs);

}  // namespace

Kurt::Kurt(const KurtParams& params)
    : odometry_(params.wheels, params.odometry),
      limiter_(params.wheels, params.limits),
      watchdog_(std::llround(1e6 * params.drive_timeout_s)) {}

void Kurt::connected(const time::Moment& now) {
  line_open_ = true;
  parser_.restart();
  session_.start(now.steady_us);
}

void Kurt::disconnected() {
  line_open_ = false;
  session_.stop();
  encoder_clock_.restart();
  last_encoder_us_.reset();
  // After a loss the robot stays stationary until a new DRIVE comes.
  watchdog_.revoke();
  limiter_.stop();
}

std::span<const OdometrySample> Kurt::receive(std::span<const std::uint8_t> bytes,
                                              const time::Moment& now) {
  ticks_.clear();
  samples_.clear();
  parser_.push(bytes, [this, &now](const SlcanLine& line) {
    session_.take(line, now.steady_us);
    if (line.kind != SlcanLine::Kind::kFrame || !session_.is_open()) {
      return;
    }
    const Report report = decode(line.frame);
    if (const auto* ticks = std::get_if<EncoderTicks>(&report)) {
      ticks_.push_back(*ticks);
    } else {
      take_sensor(report, now.steady_us);
    }
  });
  // Frames that come in one read were sent a period apart: all but the last have waited.
  std::int64_t waited = std::ssize(ticks_);
  for (const EncoderTicks& ticks : ticks_) {
    take_encoder(ticks, now.steady_us - --waited * kEncoderPeriodUs, now);
  }
  return samples_;
}

void Kurt::take_encoder(const EncoderTicks& ticks, std::int64_t arrival_us,
                        const time::Moment& now) {
  ++counts_.encoder_frames;
  if (!is_of_use(ticks, arrival_us)) {
    return;
  }
  const EncoderClock::Reading reading = encoder_clock_.take(arrival_us);
  if (reading.gap_us > 0) {
    ++counts_.encoder_gaps;
    odometry_.bridge_gap(1e-6 * static_cast<double>(reading.gap_us));
  }
  if (reading.lost > 0) {
    counts_.encoder_lost += reading.lost;
    odometry_.bridge(reading.lost);
  }
  odometry_.add(ticks);  // bridges what is not plausible
  samples_.push_back({reading.measured_us + now.utime_us - now.steady_us, odometry_.state()});
}

/// Implausible ticks say nothing about the wheels, so they must not keep the robot driving: when
/// too many come in a row, they count as none, and the robot stops as if the base were silent.
bool Kurt::is_of_use(const EncoderTicks& ticks, std::int64_t arrival_us) {
  if (odometry_.is_plausible(ticks)) {
    last_encoder_us_ = arrival_us;
    implausible_in_a_row_ = 0;
    return true;
  }
  ++counts_.encoder_implausible;
  return last_encoder_us_ && ++implausible_in_a_row_ <= kBridgedInARow;
}

void Kurt::take_sensor(const Report& report, std::int64_t now_us) {
  std::visit(
      [this, now_us](const auto& value) {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, RangeReadings>) {
          for (std::size_t i = 0; i < kInfraredCount; ++i) {
            if (value.infrared_raw[i]) {
              sensors_.infrared_raw[i] = {*value.infrared_raw[i], now_us};
            }
          }
          if (value.sonar_raw) {
            sensors_.sonar_raw = {*value.sonar_raw, now_us};
          }
        } else if constexpr (std::is_same_v<Value, Tilt>) {
          sensors_.tilt = {value, now_us};
        } else if constexpr (std::is_same_v<Value, Gyro>) {
          sensors_.gyro = {value, now_us};
        } else if constexpr (std::is_same_v<Value, MotorCurrents>) {
          sensors_.motor_currents = {value, now_us};
        }
      },
      report);
}

DriveStatus Kurt::drive(const DriveRequest& request, const time::Moment& now) {
  return watchdog_.offer(request, now.utime_us, now.steady_us);
}

KurtState Kurt::state(std::int64_t steady_us) const {
  if (!line_open_) {
    return KurtState::kNoLine;
  }
  if (!session_.is_open()) {
    return KurtState::kNoBus;
  }
  if (!last_encoder_us_ || steady_us - *last_encoder_us_ >= kBlindUs) {
    return KurtState::kNoBase;
  }
  return watchdog_.command(steady_us) ? KurtState::kDriving : KurtState::kNoDrive;
}

std::string Kurt::control(const time::Moment& now) {
  std::string text = session_.poll(now.steady_us);
  const KurtState state_now = state(now.steady_us);
  if (state_now == KurtState::kDriving) {
    limiter_.step(*watchdog_.command(now.steady_us), kControlPeriodS);
  } else {
    limiter_.stop();
  }
  if (session_.is_open()) {
    text += to_line(speed_command(limiter_.current()));
  }
  return text;
}

}  // namespace nodmap::kurt
