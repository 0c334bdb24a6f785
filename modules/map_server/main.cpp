// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/run.hpp"
#include "modules/map_server/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::map_server::MapServerNode>(
      argc, argv,
      {"nodmap-map-server",
       "Keeps the egocentric obstacle map and structure map of a nodding laser (Holz et al. 2008, "
       "III)."});
}
