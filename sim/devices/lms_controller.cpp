// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/lms_controller.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace nodmap::sim {
namespace {

constexpr std::string_view kType = "LMS200;301063;V02.10 ";
constexpr std::string_view kVersion = "V02.10 ";
constexpr std::string_view kPassword = "SICK_LMS";

constexpr std::uint8_t kNotAccepted = 0x92;
constexpr std::size_t kAvailabilityAt = 4;
constexpr std::size_t kMeasuringModeAt = 5;
constexpr std::size_t kUnitAt = 6;
constexpr std::uint8_t kIndicesBit = 0x02;

// Within what the listing allows (60 ms; 3 s for a mode; 7 s for the memory).
constexpr time::Duration kAnswerDelay = 15ms;
constexpr time::Duration kModeDelay = 50ms;
constexpr time::Duration kConfigDelay = 1s;

Bytes with_text(std::uint8_t code, std::string_view text) {
  Bytes body = {code};
  for (const char c : text) {
    body.push_back(static_cast<std::uint8_t>(c));
  }
  return body;
}

LmsAnswer answer_with(Bytes body, time::Duration delay = kAnswerDelay) {
  return {std::move(body), delay, std::nullopt, false};
}

LmsAnswer refusal() {
  return answer_with({kNotAccepted});
}

bool is_text(ByteView bytes, std::string_view text) {
  return std::ranges::equal(bytes, text);
}

bool is_variant(int field_deg, int resolution_cdeg) {
  return (field_deg == 180 && (resolution_cdeg == 100 || resolution_cdeg == 50)) ||
         (field_deg == 100 &&
          (resolution_cdeg == 100 || resolution_cdeg == 50 || resolution_cdeg == 25));
}

// The rate as encoded in the status telegram.
std::uint32_t baud_word(int baud) {
  switch (baud) {
    case 500'000:
      return 0x8001;
    case 38'400:
      return 0x8019;
    case 19'200:
      return 0x8033;
    default:
      return 0x8067;
  }
}

}  // namespace

LmsController::LmsController(Bytes config, int baud)
    : config_(std::move(config)), baud_(baud), baud_is_permanent_(baud != 9600) {}

Bytes LmsController::start() {
  mode_ = LmsMode::kOnRequest;
  variant_ = {};
  baud_ = power_on_baud();
  scan_sent();
  return with_text(0x90, kType);
}

LmsFormat LmsController::format() const {
  return {config_[kMeasuringModeAt], config_[kUnitAt] == 1};
}

bool LmsController::sends_indices() const {
  return (config_[kAvailabilityAt] & kIndicesBit) != 0;
}

LmsAnswer LmsController::answer(ByteView request) {
  const ByteView parameters = request.subspan(1);
  switch (request.front()) {
    case 0x10:
      return {{0x91}, kAnswerDelay, power_on_baud(), true};
    case 0x20:
      return set_mode(parameters);
    case 0x30:
      return request_scan(parameters);
    case 0x31:
      return answer_with(status());
    case 0x32:
      return answer_with({0xB2});  // no errors
    case 0x3A:
      return answer_with(with_text(0xBA, kType));
    case 0x3B:
      return set_variant(parameters);
    case 0x66:
      return set_baud_permanent(parameters);
    case 0x74: {
      Bytes body = {0xF4};
      append(body, config_);
      return answer_with(body);
    }
    case 0x77:
      return write_config(parameters);
    default:
      return refusal();
  }
}

LmsAnswer LmsController::set_mode(ByteView parameters) {
  if (parameters.empty()) {
    return refusal();
  }
  const bool installs = parameters[0] == 0x00;
  if (!installs && parameters.size() != 1) {
    return refusal();
  }
  switch (parameters[0]) {
    case 0x00:
      if (!is_text(parameters.subspan(1), kPassword)) {
        return answer_with({0xA0, 0x01}, kModeDelay);
      }
      break;
    case 0x10:
    case 0x24:
    case 0x25:
    case 0x2A:
      break;
    case 0x40:
      return set_baud(38'400);
    case 0x41:
      return set_baud(19'200);
    case 0x42:
      return set_baud(9'600);
    case 0x48:
      return set_baud(500'000);
    default:
      return refusal();
  }
  mode_ = static_cast<LmsMode>(parameters[0]);
  scan_sent();
  return answer_with({0xA0, 0x00}, kModeDelay);
}

LmsAnswer LmsController::set_baud(int baud) {
  baud_ = baud;
  return {{0xA0, 0x00}, kModeDelay, baud, false};
}

LmsAnswer LmsController::set_variant(ByteView parameters) {
  if (parameters.size() != 4) {
    return refusal();
  }
  const auto field_deg = static_cast<int>(little_endian(parameters.first(2)));
  const auto resolution_cdeg = static_cast<int>(little_endian(parameters.last(2)));
  const bool accepted = is_variant(field_deg, resolution_cdeg);
  if (accepted) {
    variant_ = {field_deg, resolution_cdeg};
    mode_ = LmsMode::kOnRequest;  // a running stream ends
  }
  Bytes body = {0xBB, accepted ? std::uint8_t{1} : std::uint8_t{0}};
  append_little_endian(body, static_cast<std::uint32_t>(variant_.field_deg), 2);
  append_little_endian(body, static_cast<std::uint32_t>(variant_.resolution_cdeg), 2);
  return answer_with(body, kModeDelay);
}

LmsAnswer LmsController::set_baud_permanent(ByteView parameters) {
  if (parameters.size() != 1 || parameters[0] > 1) {
    return refusal();
  }
  baud_is_permanent_ = parameters[0] == 1;
  return answer_with({0xE6, 0x00});
}

LmsAnswer LmsController::request_scan(ByteView parameters) {
  if (parameters.size() != 1 || mode_ != LmsMode::kOnRequest) {
    return refusal();
  }
  switch (parameters[0]) {
    case 0x01:
      is_scan_requested_ = true;
      break;
    case 0x08:
      is_partial_scan_requested_ = true;
      break;
    default:
      return refusal();
  }
  return answer_with({}, 0s);
}

LmsAnswer LmsController::write_config(ByteView parameters) {
  if (mode_ != LmsMode::kInstallation || parameters.size() != config_.size()) {
    return refusal();
  }
  const bool accepted =
      is_lms_measuring_mode(parameters[kMeasuringModeAt]) && parameters[kUnitAt] <= 1;
  if (accepted) {
    config_.assign(parameters.begin(), parameters.end());
  }
  Bytes body = {0xF7, accepted ? std::uint8_t{1} : std::uint8_t{0}};
  append(body, config_);
  return answer_with(body, kConfigDelay);
}

Bytes LmsController::status() const {
  constexpr std::size_t kLength = 153;  // reply code and 152 bytes
  constexpr std::uint32_t kMotorUs = 13'320 / 90;
  Bytes body(kLength, 0);
  const auto put = [&body](std::size_t at, std::uint32_t value, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      body[at + i] = static_cast<std::uint8_t>(value >> (8 * i) & 0xFFU);
    }
  };
  body[0] = 0xB1;
  std::ranges::copy(kVersion, body.begin() + 1);
  put(8, static_cast<std::uint32_t>(mode_), 1);
  put(67, kMotorUs, 2);
  put(102, config_[kMeasuringModeAt], 1);
  put(107, static_cast<std::uint32_t>(variant_.field_deg), 2);
  put(109, static_cast<std::uint32_t>(variant_.resolution_cdeg), 2);
  put(116, baud_word(baud_), 2);
  put(119, baud_is_permanent_ ? 1 : 0, 1);
  put(122, config_[kUnitAt], 1);
  put(123, 1, 1);  // laser on
  return body;
}

}  // namespace nodmap::sim
