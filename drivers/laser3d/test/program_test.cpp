// SPDX-License-Identifier: BSD-3-Clause
// nodmap-laser3d as a process. memq:// keeps it off the network.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/child_process.hpp"

namespace nodmap::laser3d {
namespace program_test {

// Each value is within its own limits.
TEST(Laser3dProgram, ParametersThatContradictEachOtherAreExitCodeTwo) {
  for (const std::vector<std::string>& wrong : {
           std::vector<std::string>{"nod.default_min_deg=20", "nod.default_max_deg=15"},
           {"laser.range_min_m=2", "laser.range_max_m=2"},
           {"servo.maestro.us_per_deg=0"},
           {"servo.id=24", "servo.kind=maestro"},
       }) {
    std::vector<std::string> command{NODMAP_LASER3D_PROGRAM, "--lcm-url", "memq://"};
    for (const std::string& assignment : wrong) {
      command.insert(command.end(), {"--set", assignment});
    }
    nodmap::test::ChildProcess process(command);
    const std::string key = wrong.front().substr(0, wrong.front().find('='));
    EXPECT_TRUE(process.wait_for_stderr(key, std::chrono::seconds(10))) << key;
    EXPECT_EQ(process.wait_for_end(std::chrono::seconds(10)), 2) << key;
  }
}

}  // namespace program_test
}  // namespace nodmap::laser3d
