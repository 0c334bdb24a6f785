// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "tests/support/pty_pair.hpp"

namespace nodmap::test {

/// A KURT2 behind an SLCAN adapter, as text in and text out. It shares no code with the driver, so
/// a mistake in one is not hidden by the same mistake in the other. Wheels reach a commanded speed
/// within one period.
class KurtEmulator {
 public:
  /// Takes text from the driver; returns the adapter's answer.
  std::string take(const std::string& text);

  /// Advances the base by 10 ms; returns the frames it sends.
  std::string tick();

  // Faults.
  bool mute_adapter = false;  ///< answers nothing
  bool has_flags = true;      ///< otherwise it refuses F
  bool has_version = true;    ///< otherwise it refuses V
  bool base_off = false;      ///< sends no frames
  int drop_encoders = 0;      ///< number of encoder frames still to be lost
  int wild_encoders = 0;      ///< number of encoder frames still to contain implausible ticks
  bool bumper = false;        ///< a bumper is touched
  bool stalled = false;       ///< no wheel turns, whatever is commanded
  bool ranges_off = false;    ///< sends no frames of the range finders
  int sonar_raw = 900;        ///< 1.1 m
  /// Rotation that the gyro reports for one of the wheels' (with the driver's calibration); empty:
  /// no gyro.
  std::optional<double> gyro_ratio;
  double gyro_deg = 0.0;  ///< its angle

  [[nodiscard]] bool channel_open() const { return open_; }
  /// Adapter reset: the channel is closed.
  void reset_adapter() { open_ = false; }

  [[nodiscard]] int left_cm_s() const { return left_cm_s_; }
  [[nodiscard]] int right_cm_s() const { return right_cm_s_; }
  /// How far the base has driven, by its left wheel.
  [[nodiscard]] double driven_m() const { return driven_m_; }
  [[nodiscard]] bool braked() const { return braked_; }
  /// Number of CONTROL frames received.
  [[nodiscard]] int commands() const { return commands_; }
  /// Number of invalid lines received.
  [[nodiscard]] int nonsense() const { return nonsense_; }

 private:
  std::string obey(const std::string& line);
  std::string obey_frame(const std::string& line);
  std::string gyro_frame();

  std::string pending_;
  bool open_ = false;
  bool rate_set_ = false;
  bool braked_ = true;
  int left_cm_s_ = 0;
  int right_cm_s_ = 0;
  double driven_m_ = 0.0;
  double left_rest_ = 0.0;
  double right_rest_ = 0.0;
  int silent_periods_ = 0;
  int periods_ = 0;
  int commands_ = 0;
  int nonsense_ = 0;
};

/// Plays the base in real time until `done`; gives up after a minute.
template <class Condition>
bool play(PtyPair& pty, KurtEmulator& base, Condition done) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  auto next_tick = std::chrono::steady_clock::now();
  while (!done() && std::chrono::steady_clock::now() < deadline) {
    const std::string answer = base.take(pty.receive_text(1, std::chrono::milliseconds(10)));
    std::string frames;
    for (; next_tick <= std::chrono::steady_clock::now();
         next_tick += std::chrono::milliseconds(10)) {
      frames += base.tick();
    }
    if (!(answer + frames).empty()) {
      pty.send(answer + frames);
    }
  }
  return done();
}

}  // namespace nodmap::test
