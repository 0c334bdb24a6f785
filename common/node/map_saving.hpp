// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <system_error>

#include "common/geometry/time.hpp"
#include "common/node/node.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap::node {

/// Decides when a process saves its map in Context::out_dir: at a SAVE_REQUEST, and again after it
/// could not be saved. A full disk does not stop the mapping: the last complete map stays, and
/// STATUS reports the error. All times are stamps of the sensor data.
class MapSaving {
 public:
  /// Saving takes a large part of a second, so a flood of requests would leave no time for the
  /// scans.
  static constexpr time::Duration kRequestPeriod = 10s;
  /// A full disk may have room by then.
  static constexpr time::Duration kRetryPeriod = 10s;

  explicit MapSaving(const Context& context) : context_(context) {}

  /// Whether to carry out a request. Rejects it (`save_request_without_out_dir`,
  /// `save_request_too_soon`) if the process has no folder for its map, or has accepted a request
  /// less than kRequestPeriod ago and did not fail to save since. Logs the requester.
  [[nodiscard]] bool accept(const nodmap::save_request_t& request, time::Timestamp now);

  /// Whether to save now: an accepted request is waiting, or the map could not be saved and
  /// kRetryPeriod has passed. Stays so while an earlier attempt is under way.
  [[nodiscard]] bool is_due(time::Timestamp now) const {
    return is_request_waiting_ || (error_ && time::is_due(now, attempted_, kRetryPeriod));
  }

  /// An attempt begins, with the map as it is now: it carries out the request that was waiting.
  void begin() { is_request_waiting_ = false; }

  /// Records and logs the outcome of an attempt. After a failure the next request is accepted at
  /// once: after the last scan no time passes, so it would otherwise be refused for ever.
  void record(const std::error_code& error, time::Timestamp now);

  /// DEGRADED if the last attempt failed.
  [[nodiscard]] std::optional<Health> problem() const;

 private:
  const Context& context_;
  std::optional<time::Timestamp> accepted_;
  bool is_request_waiting_ = false;
  bool has_logged_refusal_ = false;  // since then
  std::optional<time::Timestamp> attempted_;
  std::error_code error_;  // of the last attempt
};

}  // namespace nodmap::node
