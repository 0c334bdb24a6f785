// SPDX-License-Identifier: BSD-3-Clause
#include "common/input/save_request.hpp"

#include "common/log/log.hpp"

namespace nodmap::input {

bool accept(const nodmap::save_request_t& request, const node::Context& context) {
  if (context.out_dir.empty()) {
    context.tally.reject("save_request_without_out_dir");
    return false;
  }
  context.tally.use();
  log::get().info("map asked for by {}", request.requested_by);
  return true;
}

}  // namespace nodmap::input
