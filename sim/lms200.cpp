// SPDX-License-Identifier: BSD-3-Clause
#include "sim/lms200.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.hpp"
#include "sim/uart.hpp"

namespace nodmap::sim {
namespace {

constexpr double kNominalTurnUs = 13'320.0;
constexpr std::uint8_t kAck = 0x06;
constexpr std::uint8_t kNak = 0x15;
constexpr std::int64_t kAckUs = 5000;
/// The plant remembers 100 ms; turns before that cannot be measured any more.
constexpr std::int64_t kMemoryUs = 80'000;

double turn_us(const Lms200Settings& settings) {
  return kNominalTurnUs * (1.0 + 1e-6 * settings.mirror_ppm);
}

std::int64_t microseconds(double duration_s) {
  return std::llround(1e6 * duration_s);
}

}  // namespace

Lms200::Lms200(const Lms200Settings& settings, Beam beam, std::int64_t power_on_us)
    : settings_(settings),
      beam_(std::move(beam)),
      controller_(settings.config, settings.baud),
      baud_(settings.baud),
      power_on_us_(power_on_us),
      booted_us_(power_on_us + microseconds(settings.boot_s)),
      next_baud_(settings.baud) {}

std::int64_t Lms200::half_turn_end_us(std::int64_t turn) const {
  return power_on_us_ + std::llround((static_cast<double>(turn) + 0.5) * turn_us(settings_));
}

void Lms200::receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) {
  settle(now_us);
  if (booting_) {
    return;
  }
  reader_.feed(heard_at(baud_, bytes, baud), now_us);
  while (const auto event = reader_.next()) {
    if (const auto* request = std::get_if<LmsRequest>(&*event)) {
      obey(*request, now_us);
    } else {
      output_.send({kNak}, baud_, now_us + kAckUs);
    }
  }
}

void Lms200::transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) {
  settle(now_us);
  while (half_turn_end_us(turn_) <= now_us) {
    end_turn(now_us);
    ++turn_;
  }
  output_.take(now_us, baud, line);
}

std::int64_t Lms200::next_us() const {
  std::int64_t next = std::min(output_.next_us(), next_baud_us_);
  if (booting_) {
    next = std::min(next, booted_us_);
  } else if (measures()) {
    next = std::min(next, half_turn_end_us(turn_));
  }
  return next;
}

/// Changes of rate and the end of the start-up, when their time has come.
void Lms200::settle(std::int64_t now_us) {
  if (now_us >= next_baud_us_) {
    baud_ = next_baud_;
    next_baud_us_ = kNever;
    reader_.reset();
  }
  if (booting_ && now_us >= booted_us_) {
    booting_ = false;
    const Bytes word = controller_.start();
    baud_ = controller_.power_on_baud();
    send(word, booted_us_);
  }
}

void Lms200::obey(const LmsRequest& request, std::int64_t now_us) {
  if (request.address != 0 && request.address != settings_.address) {
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
    next_baud_us_ = output_.free_us();
  }
  if (answer.restart) {
    booting_ = true;
    booted_us_ = output_.free_us() + microseconds(settings_.boot_s);
  }
}

void Lms200::send(ByteView body, std::int64_t from_us) {
  constexpr std::uint8_t kFromTheSensor = 0x10;
  constexpr std::uint8_t kPolluted = 0x80;
  const auto status =
      static_cast<std::uint8_t>(kFromTheSensor | (settings_.polluted ? kPolluted : 0));
  output_.send(lms_telegram(settings_.address, body, status), baud_, from_us);
}

bool Lms200::measures() const {
  const LmsMode mode = controller_.mode();
  return mode == LmsMode::kStream || mode == LmsMode::kStreamPartial || controller_.scan_asked() ||
         controller_.partial_scan_asked();
}

bool Lms200::sends_partial_scans() const {
  return controller_.mode() == LmsMode::kStreamPartial || controller_.partial_scan_asked();
}

void Lms200::end_turn(std::int64_t now_us) {
  if (booting_ || !measures()) {
    return;
  }
  const int turns = controller_.variant().turns();
  if (phase_ == 0 || sends_partial_scans()) {
    // A line that is still busy when the scan is complete costs the whole scan.
    const std::int64_t last_turn = sends_partial_scans() ? turn_ : turn_ + turns - 1;
    collecting_ = output_.free_us() <= half_turn_end_us(last_turn);
    words_.clear();
  }
  collecting_ = collecting_ && half_turn_end_us(turn_) >= now_us - kMemoryUs;
  if (collecting_) {
    measure_turn();
    if (sends_partial_scans() || phase_ == turns - 1) {
      send_scan();
    }
  }
  phase_ = (phase_ + 1) % turns;
}

void Lms200::measure_turn() {
  const LmsVariant& variant = controller_.variant();
  const bool partial = sends_partial_scans();
  const int field_deg = partial ? 180 : variant.field_deg;
  const double first_deg = 90.0 - 0.5 * field_deg + 0.01 * variant.resolution_cdeg * phase_;
  const int count = phase_ == 0 ? field_deg + 1 : field_deg;
  const std::size_t stride = partial ? 1 : static_cast<std::size_t>(variant.turns());
  const std::size_t offset = partial ? 0 : static_cast<std::size_t>(phase_);
  words_.resize(partial ? static_cast<std::size_t>(count)
                        : static_cast<std::size_t>(variant.turns() * field_deg + 1));
  LmsFormat format = controller_.format();
  if (partial) {
    format.measuring_mode = kLmsPartialMode;
  }
  const auto end_us = static_cast<double>(half_turn_end_us(turn_));
  const double degree_us = turn_us(settings_) / 360.0;
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
    body.push_back(static_cast<std::uint8_t>(turn_ & 0xFF));
    body.push_back(telegram_index_++);
  }
  send(body, half_turn_end_us(turn_));
  controller_.scan_sent();
}

}  // namespace nodmap::sim
