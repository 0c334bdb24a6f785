// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_saving.hpp"

#include <string>
#include <utility>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"

namespace nodmap::node {

bool MapSaving::accept(const nodmap::save_request_t& request, time::Timestamp now) {
  if (context_.out_dir.empty()) {
    context_.counts.reject("save_request_without_out_dir");
    return false;
  }
  const std::string name = read_name(request.requested_by);
  if (!time::is_due(now, accepted_, kRequestPeriod)) {
    context_.counts.reject("save_request_too_soon");
    if (!std::exchange(has_logged_refusal_, true)) {
      log::get().warn("{} asked to save the map again within {} s: refused", name,
                      kRequestPeriod / 1s);
    }
    return false;
  }
  accepted_ = now;
  is_request_waiting_ = true;
  has_logged_refusal_ = false;
  context_.counts.use();
  log::get().info("{} asked to save the map", name);
  return true;
}

void MapSaving::record(const std::error_code& error, time::Timestamp now) {
  attempted_ = now;
  error_ = error;
  if (error) {
    accepted_.reset();
    log::get().warn("{}: map not saved: {}", context_.out_dir.string(), error.message());
  } else {
    log::get().info("map saved in {}", context_.out_dir.string());
  }
}

std::optional<Health> MapSaving::problem() const {
  if (!error_) {
    return std::nullopt;
  }
  return Health{HealthState::kDegraded, "The map cannot be saved: " + error_.message() + "."};
}

}  // namespace nodmap::node
