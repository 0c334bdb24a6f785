// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/node.hpp"
#include "modules/slam6d/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::slam6d::Slam6dNode>(
      argc, argv,
      {"nodmap-slam6d",
       "Registers the sweeps of a nodding laser into a 3D model and an OctoMap (6DOF SLAM)."});
}
