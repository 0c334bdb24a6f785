// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/process_names.hpp"
#include "common/node/run.hpp"
#include "modules/explorer/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::explorer::ExplorerNode>(
      argc, argv,
      {nodmap::node::kExplorer,
       "Sends the robot from viewpoint to viewpoint until the 2D map shows the whole building, and "
       "back to where it began."});
}
