// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/maestro.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace maestro {
namespace {

constexpr double kPulseUnitUs = 0.25;
constexpr double kSpeedUnitUsPerS = 25.0;  // a quarter of a microsecond per 10 ms
constexpr double kLargest = 0x3FFF;

// Values are sent in bytes of seven bits.
Bytes command(std::uint8_t code, int channel, double value) {
  const auto number = static_cast<unsigned>(std::lround(std::clamp(value, 0.0, kLargest)));
  return {code, static_cast<std::uint8_t>(channel), static_cast<std::uint8_t>(number & 0x7FU),
          static_cast<std::uint8_t>(number >> 7U)};
}

}  // namespace

Bytes set_target(int channel, double pulse_us) {
  return command(0x84, channel, pulse_us / kPulseUnitUs);
}

Bytes set_speed(int channel, double pulse_us_per_s) {
  return command(0x87, channel, std::max(1.0, pulse_us_per_s / kSpeedUnitUsPerS));
}

Bytes set_acceleration(int channel, int value) {
  return command(0x89, channel, value);
}

Bytes get_position(int channel) {
  return {0x90, static_cast<std::uint8_t>(channel)};
}

double pulse_us_in(ByteView answer) {
  return kPulseUnitUs * boost::endian::load_little_u16(answer.data());
}

}  // namespace maestro

namespace {

constexpr time::Duration kReadingTimeout = 50ms;
constexpr int kMissedReadingsAllowed = 3;
constexpr std::size_t kAnswerBytes = 2;
// More than any head can turn.
constexpr double kLargestPitchRad = 2.0 * std::numbers::pi;

}  // namespace

MaestroSession::MaestroSession(const ServoParams& params)
    : channel_(params.id),
      level_us_(params.maestro.level_us),
      us_per_rad_(geometry::rad_to_deg(params.maestro.us_per_deg)),
      period_(params.period()) {}

ServoOutput MaestroSession::open(time::SteadyTime now) {
  ++counts_.connections;
  is_open_ = true;
  last_error_ = "being started";
  is_waiting_ = false;
  misses_ = 0;
  last_.reset();
  next_ = now;
  aim_.restart();
  back_off_.succeeded();
  return {.send = maestro::set_acceleration(channel_, 0), .sample = std::nullopt};
}

void MaestroSession::close() {
  is_open_ = false;
  last_error_ = "not connected";
}

ServoOutput MaestroSession::poll(time::SteadyTime now) {
  if (!is_open_ || (is_waiting_ && now < asked_ + kReadingTimeout)) {
    return {};
  }
  if (is_waiting_) {
    ++counts_.unanswered;
    miss(now);
  }
  ServoOutput output;
  if (now < next_) {
    return output;
  }
  next_ = std::max(next_ + period_, now);
  if (aim_.take()) {
    const double pulse_us = level_us_ + us_per_rad_ * aim_.goal_rad();
    const double speed_us_s = std::abs(us_per_rad_) * aim_.speed_rad_s();
    output.send = maestro::set_speed(channel_, speed_us_s);
    const Bytes target = maestro::set_target(channel_, pulse_us);
    serial::append(output.send, target);
  }
  const Bytes question = maestro::get_position(channel_);
  serial::append(output.send, question);
  is_waiting_ = true;
  asked_ = now;
  answer_.clear();
  return output;
}

// Ends a reading without a usable answer.
void MaestroSession::miss(time::SteadyTime now) {
  is_waiting_ = false;
  if (++misses_ > kMissedReadingsAllowed) {
    last_error_ = "the servo controller does not answer";
    last_.reset();
    back_off_.failed(now);
    next_ = now + back_off_.wait(now);
  }
}

ServoOutput MaestroSession::receive(ByteView bytes, time::SteadyTime now) {
  if (!is_waiting_) {
    return {};
  }
  serial::append(answer_, bytes);
  if (answer_.size() < kAnswerBytes) {
    return {};
  }
  // Answers are unframed, so one that is too long is invalid.
  if (answer_.size() > kAnswerBytes) {
    ++counts_.implausible;
    miss(now);
    return {};
  }
  is_waiting_ = false;
  return {.send = {}, .sample = sample_in(answer_, now)};
}

std::optional<PitchSample> MaestroSession::sample_in(ByteView answer, time::SteadyTime now) {
  // Shorter than any servo's; 0 means that the channel is off.
  constexpr double kShortestPulseUs = 64.0;
  const double pulse_us = maestro::pulse_us_in(answer);
  if (pulse_us < kShortestPulseUs) {
    misses_ = 0;
    aim_.repeat();  // the controller has been restarted
    return std::nullopt;
  }
  const double pitch_rad = (pulse_us - level_us_) / us_per_rad_;
  if (std::abs(pitch_rad) > kLargestPitchRad) {
    ++counts_.implausible;
    miss(now);
    return std::nullopt;
  }
  misses_ = 0;
  last_error_.clear();
  back_off_.succeeded();
  PitchSample sample;
  // The pulse was read at some time between request and answer.
  sample.stamp = asked_ + (now - asked_) / 2;
  sample.pitch_rad = pitch_rad;
  if (last_ && sample.stamp > last_->stamp) {
    sample.rate_rad_s =
        (sample.pitch_rad - last_->pitch_rad) / time::seconds(sample.stamp - last_->stamp);
  }
  last_ = sample;
  return sample;
}

}  // namespace nodmap::laser3d
