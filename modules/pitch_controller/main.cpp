// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/run.hpp"
#include "modules/pitch_controller/node.hpp"

int main(int argc, char** argv) {
  return nodmap::node::run<nodmap::pitch_controller::PitchControllerNode>(
      argc, argv,
      {"nodmap-pitch-controller",
       "Nods the laser over the area of interest of the present speed, and bounds the speed by "
       "what it sees "
       "(Holz et al. 2008, II)."});
}
