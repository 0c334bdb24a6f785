// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/save_requests.hpp"

#include <string>
#include <utility>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"

namespace nodmap::node {

bool SaveRequests::accept(const nodmap::save_request_t& request, const Context& context,
                          time::Timestamp now) {
  if (context.out_dir.empty()) {
    context.counts.reject("save_request_without_out_dir");
    return false;
  }
  const std::string name = read_name(request.requested_by);
  if (!time::is_due(now, accepted_, kPeriod)) {
    context.counts.reject("save_request_too_soon");
    if (!std::exchange(has_logged_refusal_, true)) {
      log::get().warn("{} asked to save the map again within {} s: refused", name, kPeriod / 1s);
    }
    return false;
  }
  accepted_ = now;
  has_logged_refusal_ = false;
  context.counts.use();
  log::get().info("{} asked to save the map", name);
  return true;
}

}  // namespace nodmap::node
