// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/lms200.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {
namespace {

constexpr time::FineDuration kNominalRevolution(13'320.0);
constexpr std::uint8_t kAck = 0x06;
constexpr std::uint8_t kNak = 0x15;
constexpr time::Duration kAckDelay = 5ms;
// Older revolutions can no longer be measured, because the robot model stores 100 ms.
constexpr time::Duration kMemory = 80ms;

time::FineDuration revolution(const Lms200Params& params) {
  return kNominalRevolution * (1.0 + 1e-6 * params.mirror_ppm);
}

}  // namespace

Lms200::Lms200(const Lms200Params& params, Beam beam, time::SteadyTime power_on)
    : params_(params),
      beam_(std::move(beam)),
      controller_(params.config, params.baud),
      baud_(params.baud),
      power_on_(power_on),
      booted_(power_on + time::from_seconds(params.boot_s)),
      next_baud_(params.baud) {}

time::SteadyTime Lms200::half_revolution_end(std::int64_t number) const {
  return power_on_ + time::rounded((static_cast<double>(number) + 0.5) * revolution(params_));
}

void Lms200::receive(ByteView bytes, int baud, time::SteadyTime now) {
  update(now);
  if (is_booting_) {
    return;
  }
  reader_.feed(received_bytes(baud_, bytes, baud), now);
  while (const auto event = reader_.next()) {
    if (const auto* request = std::get_if<LmsRequest>(&*event)) {
      handle(*request, now);
    } else {
      output_.send({kNak}, baud_, now + kAckDelay);
    }
  }
}

void Lms200::transmit(time::SteadyTime now, int baud, Bytes& line) {
  update(now);
  while (half_revolution_end(revolution_) <= now) {
    end_revolution(now);
    ++revolution_;
  }
  output_.take(now, baud, line);
}

time::SteadyTime Lms200::next_due() const {
  time::SteadyTime next = std::min(output_.next_due(), baud_due_);
  if (is_booting_) {
    next = std::min(next, booted_);
  } else if (measures()) {
    next = std::min(next, half_revolution_end(revolution_));
  }
  return next;
}

// Changes the rate and ends the start-up when due.
void Lms200::update(time::SteadyTime now) {
  if (now >= baud_due_) {
    baud_ = next_baud_;
    baud_due_ = kNever;
    reader_.reset();
  }
  if (is_booting_ && now >= booted_) {
    is_booting_ = false;
    const Bytes greeting = controller_.start();
    baud_ = controller_.power_on_baud();
    send(greeting, booted_);
  }
}

void Lms200::handle(const LmsRequest& request, time::SteadyTime now) {
  if (request.address != 0 && request.address != params_.address) {
    return;
  }
  output_.clear();  // a request interrupts the transmission
  const LmsAnswer answer = controller_.answer(request.body);
  phase_ = 0;
  is_collecting_ = false;
  output_.send({kAck}, baud_, now + kAckDelay);
  if (!answer.body.empty()) {
    send(answer.body, now + answer.delay);
  }
  if (answer.baud) {
    next_baud_ = *answer.baud;
    baud_due_ = output_.idle_from();
  }
  if (answer.restart) {
    is_booting_ = true;
    booted_ = output_.idle_from() + time::from_seconds(params_.boot_s);
  }
}

void Lms200::send(ByteView body, time::SteadyTime from) {
  constexpr std::uint8_t kFromTheSensor = 0x10;
  constexpr std::uint8_t kPolluted = 0x80;
  const auto status =
      static_cast<std::uint8_t>(kFromTheSensor | (params_.polluted ? kPolluted : 0));
  output_.send(lms_telegram(params_.address, body, status), baud_, from);
}

bool Lms200::measures() const {
  const LmsMode mode = controller_.mode();
  return mode == LmsMode::kStream || mode == LmsMode::kStreamPartial ||
         controller_.is_scan_requested() || controller_.is_partial_scan_requested();
}

bool Lms200::sends_partial_scans() const {
  return controller_.mode() == LmsMode::kStreamPartial || controller_.is_partial_scan_requested();
}

void Lms200::end_revolution(time::SteadyTime now) {
  if (is_booting_ || !measures()) {
    return;
  }
  const int num_revolutions = controller_.variant().revolutions();
  if (phase_ == 0 || sends_partial_scans()) {
    // If the line is still busy when the scan is complete, the whole scan is dropped.
    const std::int64_t last_revolution =
        sends_partial_scans() ? revolution_ : revolution_ + num_revolutions - 1;
    is_collecting_ = output_.idle_from() <= half_revolution_end(last_revolution);
    words_.clear();
  }
  is_collecting_ = is_collecting_ && half_revolution_end(revolution_) >= now - kMemory;
  if (is_collecting_) {
    measure_revolution();
    if (sends_partial_scans() || phase_ == num_revolutions - 1) {
      send_scan();
    }
  }
  phase_ = (phase_ + 1) % num_revolutions;
}

void Lms200::measure_revolution() {
  const LmsVariant& variant = controller_.variant();
  const bool partial = sends_partial_scans();
  const int field_deg = partial ? 180 : variant.field_deg;
  const double first_deg = 90.0 - 0.5 * field_deg + 0.01 * variant.resolution_cdeg * phase_;
  const int count = phase_ == 0 ? field_deg + 1 : field_deg;
  const std::size_t stride = partial ? 1 : static_cast<std::size_t>(variant.revolutions());
  const std::size_t offset = partial ? 0 : static_cast<std::size_t>(phase_);
  words_.resize(partial ? static_cast<std::size_t>(count)
                        : static_cast<std::size_t>(variant.revolutions() * field_deg + 1));
  LmsFormat format = controller_.format();
  if (partial) {
    format.measuring_mode = kLmsPartialMode;
  }
  const time::FineSteadyTime end = half_revolution_end(revolution_);
  const time::FineDuration degree = revolution(params_) / 360.0;
  for (int i = 0; i < count; ++i) {
    const double from_right_deg = first_deg + i;
    const time::SteadyTime fired = time::rounded(end - (180.0 - from_right_deg) * degree);
    const Echo echo = beam_(geometry::deg_to_rad(from_right_deg - 90.0), fired);
    words_[offset + stride * static_cast<std::size_t>(i)] = lms_word(echo, format);
  }
}

void Lms200::send_scan() {
  const bool millimetres = controller_.format().millimetres;
  const int quarter = phase_ * controller_.variant().resolution_cdeg / 25;
  Bytes body = {0xB0};
  append_little_endian(body,
                       sends_partial_scans()
                           ? lms_header(words_.size(), millimetres, LmsPartial{quarter})
                           : lms_header(words_.size(), millimetres),
                       2);
  for (const std::uint16_t word : words_) {
    append_little_endian(body, word, 2);
  }
  if (controller_.sends_indices()) {
    body.push_back(static_cast<std::uint8_t>(revolution_ & 0xFF));
    body.push_back(telegram_index_++);
  }
  send(body, half_revolution_end(revolution_));
  controller_.scan_sent();
}

}  // namespace nodmap::sim
