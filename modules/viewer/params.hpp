// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/viewer/foxglove/feed.hpp"

namespace nodmap::viewer {

struct ViewerParams {
  int update_ms = 20;
  int max_clients = 256;
  int idle_timeout_s = 30;
  foxglove::FeedParams feed;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("update_ms", update_ms, {5, 1000},
              "Period at which messages are taken from LCM and sent to the clients.");
    v.integer("max_clients", max_clients, {1, 1000},
              "Greatest number of simultaneous connections; a page has up to seven while it loads. "
              "A further one replaces the oldest that does not control the robot; if all do, it is "
              "refused.");
    v.integer("idle_timeout_s", idle_timeout_s, {2, 3600},
              "A client that has not answered a ping for this long is disconnected.");
    feed.describe(v);
  }
};

}  // namespace nodmap::viewer
