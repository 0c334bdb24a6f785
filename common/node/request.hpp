// SPDX-License-Identifier: BSD-3-Clause
// What programs share that ask a process for something on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <set>
#include <string>

#include "common/bus/live_bus.hpp"

namespace nodmap::node {

struct RequestOptions {
  std::string by;        ///< name of the requester, for the log
  double wait_s = 10.0;  ///< how long to wait for the process that is asked
};

/// Adds --by and --wait, whose help is `wait_help`.
void add_request_options(CLI::App& app, RequestOptions& options, const std::string& wait_help);

/// Handles messages until `is_done()` is true, which is asked after each turn of 100 ms at most.
/// Whether it became so within `wait_s` seconds, and before this process was to stop.
[[nodiscard]] bool handle_until(bus::LiveBus& bus, double wait_s,
                                const std::function<bool()>& is_done);

/// Ends a program that has published its one request to the processes `names`: tells on stdout
/// which of them are heard on STATUS within `wait_s` seconds, which comes once a second from each.
/// LCM gives no receipt: who listens is known by this alone. Returns the exit code: 1, with the
/// reason in the log, when the request was not sent or none of them was heard.
[[nodiscard]] int report_request(bus::LiveBus& bus, const std::set<std::string>& names,
                                 double wait_s);

}  // namespace nodmap::node
