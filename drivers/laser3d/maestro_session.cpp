// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/maestro_session.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/laser3d/maestro.hpp"

namespace nodmap::laser3d {
namespace {

constexpr std::int64_t kAnswerUs = 50'000;
constexpr int kMissesAllowed = 3;
constexpr std::size_t kAnswerBytes = 2;

}  // namespace

ServoOutput MaestroSession::open(std::int64_t now_us) {
  open_ = true;
  trouble_ = "being started";
  waiting_ = false;
  misses_ = 0;
  last_.reset();
  next_us_ = now_us;
  move_pending_ = speed_rad_s_ > 0.0;
  back_off_.succeeded();
  return {.send = maestro::set_acceleration(settings_.channel, 0), .sample = std::nullopt};
}

void MaestroSession::close() {
  open_ = false;
  trouble_ = "not connected";
}

void MaestroSession::aim(double goal_rad, double speed_rad_s) {
  if (goal_rad != goal_rad_ || speed_rad_s != speed_rad_s_) {
    goal_rad_ = goal_rad;
    speed_rad_s_ = speed_rad_s;
    move_pending_ = true;
  }
}

ServoOutput MaestroSession::poll(std::int64_t now_us) {
  if (!open_ || (waiting_ && now_us < asked_us_ + kAnswerUs)) {
    return {};
  }
  if (waiting_) {
    waiting_ = false;
    if (++misses_ > kMissesAllowed) {
      trouble_ = "the servo controller does not answer";
      last_.reset();
      back_off_.failed(now_us);
      next_us_ = now_us + back_off_.wait_us(now_us);
    }
  }
  ServoOutput output;
  if (now_us < next_us_) {
    return output;
  }
  next_us_ = std::max(next_us_ + settings_.period_us, now_us);
  if (move_pending_) {
    move_pending_ = false;
    const double pulse_us = settings_.level_pulse_us + settings_.pulse_us_per_rad * goal_rad_;
    const double speed_us_s = std::abs(settings_.pulse_us_per_rad) * speed_rad_s_;
    output.send = maestro::set_speed(settings_.channel, speed_us_s);
    const Bytes target = maestro::set_target(settings_.channel, pulse_us);
    append(output.send, target);
  }
  const Bytes question = maestro::get_position(settings_.channel);
  append(output.send, question);
  waiting_ = true;
  asked_us_ = now_us;
  answer_.clear();
  return output;
}

ServoOutput MaestroSession::receive(ByteView bytes, std::int64_t now_us) {
  if (!waiting_) {
    return {};
  }
  append(answer_, bytes);
  if (answer_.size() < kAnswerBytes) {
    return {};
  }
  waiting_ = false;
  // Bare bytes have no frame: an answer that is too long is none.
  if (answer_.size() > kAnswerBytes) {
    return {};
  }
  return {.send = {}, .sample = sample_in(answer_, now_us)};
}

std::optional<PitchSample> MaestroSession::sample_in(ByteView answer, std::int64_t now_us) {
  constexpr double kShortestPulseUs = 64.0;  // of any servo; 0: the channel is off
  const double pulse_us = maestro::pulse_us_in(answer);
  misses_ = 0;
  if (pulse_us < kShortestPulseUs) {
    move_pending_ = true;  // the controller has been restarted
    return std::nullopt;
  }
  trouble_.clear();
  back_off_.succeeded();
  PitchSample sample;
  // The pulse was looked up somewhere between question and answer.
  sample.time_us = asked_us_ + (now_us - asked_us_) / 2;
  sample.pitch_rad = (pulse_us - settings_.level_pulse_us) / settings_.pulse_us_per_rad;
  if (last_ && sample.time_us > last_->time_us) {
    sample.rate_rad_s = 1e6 * (sample.pitch_rad - last_->pitch_rad) /
                        static_cast<double>(sample.time_us - last_->time_us);
  }
  last_ = sample;
  return sample;
}

}  // namespace nodmap::laser3d
