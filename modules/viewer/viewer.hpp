// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>

#include "common/geometry/time.hpp"
#include "common/node/cpu_load.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "modules/viewer/hub.hpp"
#include "modules/viewer/options.hpp"
#include "modules/viewer/pace.hpp"
#include "modules/viewer/params.hpp"
#include "modules/viewer/server.hpp"
#include "modules/viewer/session.hpp"
#include "modules/viewer/site.hpp"

namespace nodmap::viewer {

/// The viewer without its source of messages: shows a topic store to all clients, as often as the
/// machine's load permits.
class Viewer : private boost::noncopyable {
 public:
  /// Listens, and prints the page's address. `store` has all its topics already. Site and store
  /// must outlive this object. Throws as Server does.
  Viewer(const Options& options, const ViewerParams& params, const Site& site,
         const foxglove::TopicStore& store, Services services);
  ~Viewer();

  /// Serves clients for one period.
  void serve() { server_.run_for(period_); }

  /// Sends every client what is due. To be called after each serve().
  void poll();

  [[nodiscard]] Server& server() { return server_; }

 private:
  void adapt_pace(time::SteadyTime now);

  Services services_;
  Hub hub_;
  Server server_;
  std::chrono::milliseconds period_;
  Pace pace_;
  node::CpuLoad load_;
  time::SteadyTime load_due_{};
};

}  // namespace nodmap::viewer
