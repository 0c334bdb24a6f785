// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/node/node.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap::input {

/// Whether a process that keeps a map is to save it now, as it is asked to: it must have a folder
/// for it, else the request is rejected (`save_request_without_out_dir`). Says in the log who
/// asked.
[[nodiscard]] bool accept(const nodmap::save_request_t& request, const node::Context& context);

}  // namespace nodmap::input
