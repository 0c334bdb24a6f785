// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/lms200.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {
namespace {

constexpr double kNominalRevolutionUs = 13'320.0;
constexpr std::uint8_t kAck = 0x06;
constexpr std::uint8_t kNak = 0x15;
constexpr std::int64_t kAckUs = 5000;
/// The robot model keeps 100 ms; older revolutions cannot be measured any more.
constexpr std::int64_t kMemoryUs = 80'000;

double revolution_us(const Lms200Params& params) {
  return kNominalRevolutionUs * (1.0 + 1e-6 * params.mirror_ppm);
}

std::int64_t microseconds(double duration_s) {
  return std::llround(1e6 * duration_s);
}

}  // namespace

Lms200::Lms200(const Lms200Params& params, Beam beam, std::int64_t power_on_us)
    : params_(params),
      beam_(std::move(beam)),
      controller_(params.config, params.baud),
      baud_(params.baud),
      power_on_us_(power_on_us),
      booted_us_(power_on_us + microseconds(params.boot_s)),
      next_baud_(params.baud) {}

std::int64_t Lms200::half_revolution_end_us(std::int64_t revolution) const {
  return power_on_us_ +
         std::llround((static_cast<double>(revolution) + 0.5) * revolution_us(params_));
}

void Lms200::receive(ByteView bytes, int baud, std::int64_t now_us) {
  update(now_us);
  if (booting_) {
    return;
  }
  reader_.feed(received_bytes(baud_, bytes, baud), now_us);
  while (const auto event = reader_.next()) {
    if (const auto* request = std::get_if<LmsRequest>(&*event)) {
      handle(*request, now_us);
    } else {
      output_.send({kNak}, baud_, now_us + kAckUs);
    }
  }
}

void Lms200::transmit(std::int64_t now_us, int baud, Bytes& line) {
  update(now_us);
  while (half_revolution_end_us(revolution_) <= now_us) {
    end_revolution(now_us);
    ++revolution_;
  }
  output_.take(now_us, baud, line);
}

std::int64_t Lms200::next_us() const {
  std::int64_t next = std::min(output_.next_us(), next_baud_us_);
  if (booting_) {
    next = std::min(next, booted_us_);
  } else if (measures()) {
    next = std::min(next, half_revolution_end_us(revolution_));
  }
  return next;
}

/// Changes the rate and ends the start-up when they are due.
void Lms200::update(std::int64_t now_us) {
  if (now_us >= next_baud_us_) {
    baud_ = next_baud_;
    next_baud_us_ = kNever;
    reader_.reset();
  }
  if (booting_ && now_us >= booted_us_) {
    booting_ = false;
    const Bytes greeting = controller_.start();
    baud_ = controller_.power_on_baud();
    send(greeting, booted_us_);
  }
}

void Lms200::handle(const LmsRequest& request, std::int64_t now_us) {
  if (request.address != 0 && request.address != params_.address) {
    return;
  }
  output_.clear();  // a request interrupts what is being sent
  const LmsAnswer answer = controller_.answer(request.body);
  phase_ = 0;
  collecting_ = false;
  output_.send({kAck}, baud_, now_us + kAckUs);
  if (!answer.body.empty()) {
    send(answer.body, now_us + answer.delay_us);
  }
  if (answer.baud) {
    next_baud_ = *answer.baud;
    next_baud_us_ = output_.idle_from_us();
  }
  if (answer.restart) {
    booting_ = true;
    booted_us_ = output_.idle_from_us() + microseconds(params_.boot_s);
  }
}

void Lms200::send(ByteView body, std::int64_t from_us) {
  constexpr std::uint8_t kFromTheSensor = 0x10;
  constexpr std::uint8_t kPolluted = 0x80;
  const auto status =
      static_cast<std::uint8_t>(kFromTheSensor | (params_.polluted ? kPolluted : 0));
  output_.send(lms_telegram(params_.address, body, status), baud_, from_us);
}

bool Lms200::measures() const {
  const LmsMode mode = controller_.mode();
  return mode == LmsMode::kStream || mode == LmsMode::kStreamPartial ||
         controller_.scan_requested() || controller_.partial_scan_requested();
}

bool Lms200::sends_partial_scans() const {
  return controller_.mode() == LmsMode::kStreamPartial || controller_.partial_scan_requested();
}

void Lms200::end_revolution(std::int64_t now_us) {
  if (booting_ || !measures()) {
    return;
  }
  const int num_revolutions = controller_.variant().revolutions();
  if (phase_ == 0 || sends_partial_scans()) {
    // A line that is still busy when the scan is complete drops the whole scan.
    const std::int64_t last_revolution =
        sends_partial_scans() ? revolution_ : revolution_ + num_revolutions - 1;
    collecting_ = output_.idle_from_us() <= half_revolution_end_us(last_revolution);
    words_.clear();
  }
  collecting_ = collecting_ && half_revolution_end_us(revolution_) >= now_us - kMemoryUs;
  if (collecting_) {
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
  const auto end_us = static_cast<double>(half_revolution_end_us(revolution_));
  const double degree_us = revolution_us(params_) / 360.0;
  for (int i = 0; i < count; ++i) {
    const double from_right_deg = first_deg + i;
    const std::int64_t fired_us = std::llround(end_us - (180.0 - from_right_deg) * degree_us);
    const Echo echo = beam_(geometry::deg_to_rad(from_right_deg - 90.0), fired_us);
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
  send(body, half_revolution_end_us(revolution_));
  controller_.scan_sent();
}

}  // namespace nodmap::sim
