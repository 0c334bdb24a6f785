// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world_name.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/data_dir.hpp"

namespace nodmap::sim {
namespace world_name_test {

using ::testing::HasSubstr;

std::string error_of(const std::string& name) {
  try {
    (void)make_world(name);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(WorldName, ARandomWorldNeedsASeed) {
  EXPECT_FALSE(make_world("random:3").objects.empty());
  EXPECT_THAT(error_of("random:x"), HasSubstr("random:SEED"));
}

TEST(WorldName, NobodyWalksBeyondWhatAWorldMayContain) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "crowd.txt";
  std::ofstream(file) << "1 1 0 0\n2 1 1e8 5\n";
  EXPECT_THAT(error_of("pedestrians:" + file + ":15:1"), HasSubstr("crowd.txt:2: expected frame"));
}

TEST(WorldName, ThePedestriansOfAFileMayBeNumberedInFloats) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "crowd.txt";
  const auto first_positions = [&](const std::string& lines) {
    std::ofstream(file) << lines;
    std::vector<Eigen::Vector2d> positions;
    for (const Actor& actor : make_world("pedestrians:" + file + ":1:1").actors) {
      positions.push_back(actor.path.front().position);
    }
    return positions;
  };
  const std::vector<Eigen::Vector2d> expected{{2.0, 3.0}, {8.0, 9.0}};
  EXPECT_EQ(first_positions("1 1 2 3\n2 1 4 5\n1 2 8 9\n2 2 7 9\n"), expected);
  EXPECT_EQ(first_positions("1.0\t1.0\t2\t3\n2.0\t1.0\t4\t5\n1 2.0 8 9 \r\n2 2 7 9\n"), expected);
}

TEST(WorldName, AFileOfPedestriansHasFourColumns) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "crowd.txt";
  for (const char* line :
       {"2 1 4 5 6", "2 1 4 5 x", "2 1 4", "2 1.5 4 5", "2 1e12 4 5", "2 1 4 0 5 1.2 0 0.1"}) {
    std::ofstream(file) << "1 1 2 3\n" << line << "\n";
    EXPECT_THAT(error_of("pedestrians:" + file + ":15:1"), HasSubstr("crowd.txt:2: expected frame"))
        << line;
  }
}

TEST(WorldName, NamesAWorldByKindAndSeed) {
  EXPECT_EQ(make_world("holes:2").name, "holes-trench");
  EXPECT_EQ(make_world("dead-end:1").goals.size(), 1U);
  EXPECT_THAT(error_of("maze:x"), HasSubstr("maze:SEED"));
  EXPECT_THAT(error_of("barn:file"), HasSubstr("barn:FILE:INDEX"));
  EXPECT_THAT(error_of("barn:none:1"), HasSubstr("cannot open"));
  EXPECT_THAT(error_of("pedestrians:none:0:1"), HasSubstr("FRAMES"));
  EXPECT_THAT(error_of("nothing:1"), HasSubstr("nothing:1: no such scenario; there are building,"));
  EXPECT_THAT(error_of("nothing"), HasSubstr("cannot open")) << "a file";
}

}  // namespace world_name_test
}  // namespace nodmap::sim
