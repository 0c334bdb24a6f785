// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::viewer {

struct ViewerParams {
  int update_ms = 20;
  int max_clients = 256;
  int max_cloud_points = 2'000'000;
  double cloud_spacing_m = 0.03;
  int idle_timeout_s = 30;
  double trail_spacing_m = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("update_ms", update_ms, {5, 1000},
              "How often messages are taken from LCM and handed to the clients.");
    v.integer("max_clients", max_clients, {1, 1000},
              "Connections at once; a page has up to seven while it loads. More are refused.");
    v.integer("max_cloud_points", max_cloud_points, {1000, 100'000'000},
              "Points of CLOUD kept for clients that come later; the oldest keyframes go first.");
    v.number(
        "cloud_spacing_m", cloud_spacing_m, {0.0, 1.0},
        "A point of CLOUD is left out where one this near has been shown, so that memory grows "
        "with the building, not with the time; 0 shows all.");
    v.integer("idle_timeout_s", idle_timeout_s, {2, 3600},
              "A client that answers no ping for so long is disconnected.");
    v.number("trail_spacing_m", trail_spacing_m, {0.001, 10.0},
             "Poses of the trails are at least this far apart; the newest 2000 of each are kept.");
  }
};

}  // namespace nodmap::viewer
