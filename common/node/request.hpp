// SPDX-License-Identifier: BSD-3-Clause
// Shared by the command-line programs that send a request to a process.
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

/// Adds the options --by and --wait; `wait_help` is the help text of --wait.
void add_request_options(CLI::App& app, RequestOptions& options, const std::string& wait_help);

/// Handles messages until `is_done()`, which is called at least every 100 ms. Returns false if that
/// takes more than `wait_s` seconds or this process is told to stop.
[[nodiscard]] bool handle_until(bus::LiveBus& bus, double wait_s,
                                const std::function<bool()>& is_done);

/// Reports whether a published request had a recipient: waits up to `wait_s` seconds for the STATUS
/// of the processes in `names`, and prints on stdout those from which one was received. (LCM
/// does not acknowledge messages; each process publishes its STATUS once a second.) Returns the
/// exit code: 1, with the reason in the log, if the request was not sent or no STATUS was received.
[[nodiscard]] int report_request(bus::LiveBus& bus, const std::set<std::string>& names,
                                 double wait_s);

}  // namespace nodmap::node
