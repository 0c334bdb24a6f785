// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/test/kurt_emulator.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace nodmap::test {
namespace {

constexpr double kTicksPerCm = 21950.0 / 37.9;

// Whole ticks in 10 ms at this speed; the remainder is kept in `rest` for the next call.
int ticks_of(int speed_cm_s, double& rest) {
  const double ticks = 0.01 * speed_cm_s * kTicksPerCm + rest;
  const double whole = std::trunc(ticks);
  rest = ticks - whole;
  return static_cast<int>(whole);
}

std::string printed(const char* format, unsigned a, unsigned b) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), format, a & 0xFFFFU, b & 0xFFFFU);
  return text.data();
}

}  // namespace

std::string KurtEmulator::take(const std::string& text) {
  std::string answer;
  for (const char c : text) {
    if (c != '\r') {
      pending_ += c;
      continue;
    }
    answer += obey(pending_);
    pending_.clear();
  }
  return mute_adapter ? "" : answer;
}

std::string KurtEmulator::obey(const std::string& line) {
  if (line.empty()) {
    return "\r";
  }
  if (line == "C") {
    const bool was_open = open_;
    open_ = false;
    return was_open ? "\r" : "\a";
  }
  if (line == "S8") {
    rate_set_ = !open_;
    return open_ ? "\a" : "\r";
  }
  if (line == "O") {
    open_ = rate_set_;
    return open_ ? "\r" : "\a";
  }
  if (line == "F") {
    return open_ && has_flags ? "F00\r" : "\a";
  }
  if (line == "V") {
    return has_version ? "V1013\r" : "\a";
  }
  return open_ ? obey_frame(line) : "\a";
}

std::string KurtEmulator::obey_frame(const std::string& line) {
  unsigned mode = 0;
  unsigned left = 0;
  unsigned right = 0;
  unsigned windup = 0;
  if (std::sscanf(line.c_str(), "t0018%4X%4X%4X%4X", &mode, &left, &right, &windup) != 4 ||
      line.size() != 21) {
    ++nonsense_;
    return "\a";
  }
  ++commands_;
  silent_periods_ = 0;
  braked_ = line == "t001800000103FF0103FF";
  const bool speed = mode == 2 && windup == 1;
  if (!braked_ && !speed) {
    ++nonsense_;
  }
  left_cm_s_ = speed ? static_cast<std::int16_t>(left) : 0;
  right_cm_s_ = speed ? static_cast<std::int16_t>(right) : 0;
  return "z\r";
}

// Every seventh period, with the angle at the end of the last period.
std::string KurtEmulator::gyro_frame() {
  if (!gyro_ratio || ++periods_ % 7 != 0) {
    return "";
  }
  const auto angle = static_cast<std::uint32_t>(std::llround(gyro_deg * 4'992'511.0));
  return printed("t00E8%04X%04X00000000\r", angle >> 16U, angle);
}

std::string KurtEmulator::tick() {
  if (++silent_periods_ > 10) {  // 100 ms without a command
    left_cm_s_ = 0;
    right_cm_s_ = 0;
  }
  const int left = stalled ? 0 : ticks_of(left_cm_s_, left_rest_);
  const int right = stalled ? 0 : ticks_of(right_cm_s_, right_rest_);
  const double left_m = left * 0.01 / kTicksPerCm;
  const double right_m = right * 0.01 / kTicksPerCm;
  driven_m_ += left_m;
  if (base_off || mute_adapter || !open_) {
    return "";
  }
  std::string frames =
      ranges_off ? ""
                 : printed("t0068012C%04X0064%04X\r", static_cast<unsigned>(sonar_raw), 0x0064U);
  frames += bumper ? "t00A20400\r" : "t00A20000\r";
  frames += gyro_frame();
  gyro_deg += gyro_ratio.value_or(0.0) * (right_m - left_m) / 0.28 * 0.69 * 180.0 / M_PI;
  if (drop_encoders > 0) {
    --drop_encoders;
    return frames;
  }
  if (wild_encoders > 0) {
    --wild_encoders;
    return frames + printed("t0098%04X%04X00000000\r", 0x7FFFU, 0x8000U);
  }
  return frames + printed("t0098%04X%04X00000000\r", static_cast<unsigned>(left),
                          static_cast<unsigned>(right));
}

}  // namespace nodmap::test
