// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/viewer.hpp"

#include <iostream>
#include <string>
#include <utility>

#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "modules/viewer/access.hpp"
#include "modules/viewer/log_history.hpp"

namespace nodmap::viewer {
namespace {

constexpr time::Duration kLoadPeriod = 1s;

std::string page_address(const std::string& host, std::uint16_t port) {
  const bool is_v6 = host.find(':') != std::string::npos;
  return "http://" + (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port) + "/";
}

}  // namespace

Viewer::Viewer(const Options& options, const ViewerParams& params, const Site& site,
               const foxglove::TopicStore& store, Services services)
    : services_(std::move(services)),
      hub_{.site = site,
           .store = store,
           .services = services_,
           .policy = {.loopback_only = is_loopback(options.bind),
                      .token = options.control ? make_token() : std::string()},
           .max_connections = params.max_clients,
           .idle_timeout_s = params.idle_timeout_s},
      server_(hub_, options.bind, options.port),
      period_(params.update_ms),
      pace_(period_) {
  services_.metadata = {{"max_cloud_points", std::to_string(params.feed.max_cloud_points)},
                        {"gap_s", std::to_string(kGapS)},
                        {"status_gap_s", std::to_string(kStatusGapS)}};
  const std::string page = page_address(options.bind, server_.port());
  log::get().info("page on {}; Foxglove and Lichtblick: ws{}", page, page.substr(4));
  if (options.control) {
    // On stdout, so that the token does not get into a log file.
    std::cout << "control: " << page << "#token=" << hub_.policy.token << std::endl;
  }
}

Viewer::~Viewer() {
  for (const auto& [cause, count] : hub_.counts.rejected()) {
    log::get().info("refused to clients: {} {}", count, cause);
  }
}

void Viewer::poll() {
  const time::SteadyTime now = time::steady_now();
  adapt_pace(now);
  hub_.sends_news = pace_.take_update(now);
  server_.poll();
}

void Viewer::adapt_pace(time::SteadyTime now) {
  if (now < load_due_) {
    return;
  }
  load_due_ = now + kLoadPeriod;
  load_.sample();
  const bool was_slowed = pace_.is_slowed();
  pace_.note_load(load_.share());
  if (pace_.is_slowed() != was_slowed) {
    log::get().info(was_slowed ? "clients are updated at the full rate again"
                               : "the machine is busy: clients are updated less often");
  }
}

}  // namespace nodmap::viewer
