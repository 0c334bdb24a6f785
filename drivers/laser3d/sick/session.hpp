// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "drivers/laser3d/sick/step.hpp"
#include "drivers/serial/back_off.hpp"

namespace nodmap::laser3d {

/// What the caller must do, in this order, and the scan that was received.
struct SickOutput {
  std::optional<int> baud;  ///< change the rate of the host's line
  Bytes send;
  std::optional<SickScan> scan;
};

/// Brings the sensor from an unknown state to a stream of scans, and again whenever the stream
/// ends. A pure state machine without clock or port.
///
/// Finds the rate of the sensor (which may be streaming already), changes it, writes the
/// configuration only if it differs (the sensor's memory wears out), sets the variant and starts
/// the stream.
class SickSession {
 public:
  enum class State : std::uint8_t { kClosed, kConnecting, kStreaming, kWaiting };

  struct Counts {
    std::int64_t scans = 0;
    std::int64_t connections = 0;
    std::int64_t config_writes = 0;
    std::int64_t retries = 0;
    std::int64_t unexpected_scans = 0;  ///< of another variant, or while none were expected
    std::int64_t stream_stops = 0;
    std::int64_t freezes = 0;
    std::int64_t power_ons = 0;  ///< telegrams by which the sensor reports that it was switched on
  };

  explicit SickSession(const SickParams& params);

  /// To be called when the line has been opened.
  [[nodiscard]] SickOutput open(time::SteadyTime now);
  /// To be called when the line is gone.
  void close();
  /// Ends the stream and sets the sensor's rate back to 9600, where the next start finds it at
  /// once.
  [[nodiscard]] SickOutput shut_down(time::SteadyTime now);

  /// Handles retries, timeouts and back-off; to be called at least every few milliseconds.
  [[nodiscard]] SickOutput poll(time::SteadyTime now);
  [[nodiscard]] SickOutput take(const SickTelegram& telegram, time::SteadyTime now);
  /// The sensor did not understand a request; repeats it soon.
  void take_nak(time::SteadyTime now);

  [[nodiscard]] State state() const;
  /// Why the last attempt or stream ended; empty while scans are received.
  [[nodiscard]] const std::string& last_error() const { return last_error_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// The longest pause in a healthy stream.
  [[nodiscard]] time::Duration stream_timeout() const;

 private:
  using Step = SickStep;

  [[nodiscard]] time::Duration timeout() const;

  [[nodiscard]] SickOutput enter(Step step, time::SteadyTime now);
  [[nodiscard]] SickOutput ask(time::SteadyTime now);
  [[nodiscard]] SickOutput retry(time::SteadyTime now);
  [[nodiscard]] SickOutput search_from(std::size_t candidate, time::SteadyTime now);
  [[nodiscard]] SickOutput advance(const SickTelegram& telegram, time::SteadyTime now);
  [[nodiscard]] SickOutput after_config(const SickTelegram& telegram, time::SteadyTime now);
  [[nodiscard]] SickOutput take_values(const SickTelegram& telegram, time::SteadyTime now);
  [[nodiscard]] SickOutput fail(std::string reason, time::SteadyTime now);
  [[nodiscard]] bool is_expected_count(std::size_t count) const;
  /// Compares the scan with the one before; returns whether they have been the same for too long.
  [[nodiscard]] bool watch_for_frozen_scans(const SickTelegram& telegram, const SickScan& scan);

  SickParams params_;
  std::vector<int> candidates_;  // rates to try, the most likely first
  std::size_t candidate_ = 0;
  int baud_ = 9600;
  Step step_ = Step::kClosed;
  int attempts_ = 0;
  bool is_refused_ = false;
  bool is_answering_ = false;  // a complete telegram was received at this rate
  time::SteadyTime deadline_;
  std::optional<SickConfig> config_;
  int writes_since_wanted_ = 0;  // of the configuration, since it was last read as wanted
  serial::BackOff back_off_;
  std::array<Bytes, 4> last_values_;  // by quarter of a degree; complete scans use the first
  int equal_scans_ = 0;
  std::string last_error_ = "not connected";
  Counts counts_;
};

}  // namespace nodmap::laser3d
