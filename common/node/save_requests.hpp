// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"
#include "common/node/node.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap::node {

/// Decides whether to carry out a SAVE_REQUEST. Saving takes a large part of a second, so a flood
/// of requests would leave no time for the scans.
class SaveRequests {
 public:
  static constexpr time::Duration kPeriod = 10s;

  /// Whether to carry out a request at `now`, by the stamps of the sensor data. Rejects it
  /// (`save_request_without_out_dir`, `save_request_too_soon`) if the process has no folder for its
  /// map, or has accepted a request less than kPeriod ago, unless forget() was called since. Logs
  /// the requester.
  [[nodiscard]] bool accept(const nodmap::save_request_t& request, const Context& context,
                            time::Timestamp now);

  /// To be called when the map could not be saved: the next request is carried out at once. After
  /// the last scan no time passes, so it would otherwise be refused for ever.
  void forget() { accepted_.reset(); }

 private:
  std::optional<time::Timestamp> accepted_;
  bool has_logged_refusal_ = false;  // since then
};

}  // namespace nodmap::node
