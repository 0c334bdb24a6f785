// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/map_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/formats/input_file.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::slam2d {
namespace map_file_test {

std::string slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

TEST(MapFile, ARosMapIsWrittenWithItsYAxisUpwards) {
  const nodmap::test::TemporaryDir dir;
  OccupancyGrid grid(0.5);
  ASSERT_TRUE(grid.add_ray({0.25, 0.25}, {0.25, 1.25}));  // a wall to the left; y is up
  ASSERT_TRUE(grid.add_ray({-1.25, 0.25}, {-1.25, 0.75}));
  ASSERT_FALSE(write_ros_map(dir.path(), grid));

  const std::string pgm = slurp(dir.path() / "map.pgm");
  const std::string head =
      "P5\n" + std::to_string(grid.width()) + " " + std::to_string(grid.height()) + "\n255\n";
  ASSERT_EQ(pgm.substr(0, head.size()), head);
  ASSERT_EQ(pgm.size(), head.size() + static_cast<std::size_t>(grid.width() * grid.height()));
  const auto pixel = [&](double x_m, double y_m) {
    const int x = static_cast<int>(std::floor((x_m - grid.origin().x()) / 0.5));
    const int y = static_cast<int>(std::floor((y_m - grid.origin().y()) / 0.5));
    return static_cast<unsigned char>(
        pgm[head.size() + static_cast<std::size_t>((grid.height() - 1 - y) * grid.width() + x)]);
  };
  EXPECT_EQ(pixel(0.25, 0.25), 254);
  EXPECT_EQ(pixel(0.25, 1.25), 0);
  EXPECT_EQ(pixel(1.25, 0.25), 205);

  const std::string yaml = slurp(dir.path() / "map.yaml");
  EXPECT_NE(yaml.find("image: map.pgm\n"), std::string::npos);
  EXPECT_NE(yaml.find("resolution: 0.5\n"), std::string::npos);
  EXPECT_NE(yaml.find("origin: [-64, 0, 0]\n"), std::string::npos);
}

TEST(MapFile, NegateMayBeANumberOrABoolean) {
  const nodmap::test::TemporaryDir dir;
  std::ofstream(dir.path() / "map.pgm") << "P2\n1 1\n255\n0\n";  // black
  const auto cell = [&](const std::string& line) {
    std::ofstream(dir.path() / "map.yaml") << "image: map.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n"
                                           << line << "\n";
    return read_ros_map(dir.path()).cells.at(0);
  };
  for (const char* no : {"", "negate: 0", "negate: false", "negate: False", "negate: FALSE",
                         "negate: no", "negate: off", "mode: scale"}) {
    EXPECT_EQ(cell(no), CellState::kOccupied) << no;
  }
  for (const char* yes : {"negate: 1", "negate: true", "negate: True", "negate: yes"}) {
    EXPECT_EQ(cell(yes), CellState::kFree) << yes;
  }
  EXPECT_THROW(cell("negate: maybe"), std::runtime_error);
  EXPECT_THROW(cell("mode: raw"), std::runtime_error);  // its values are percentages
}

TEST(MapFile, AMapIsReadAsItWasWritten) {
  const nodmap::test::TemporaryDir dir;
  const OccupancyGrid grid = test::drawn_grid(test::room(), test::poses_in_room());
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  const TrinaryGrid expected = trinary(grid);
  for (const auto& path : {dir.path(), dir.path() / "map.yaml"}) {
    const TrinaryGrid read = read_ros_map(path);
    EXPECT_EQ(read.cells, expected.cells);
    EXPECT_EQ(read.width, expected.width);
    EXPECT_DOUBLE_EQ(read.cell_size_m, expected.cell_size_m);
    EXPECT_NEAR(read.T_map_grid.x, expected.T_map_grid.x, 1e-9);
    EXPECT_NEAR(read.T_map_grid.y, expected.T_map_grid.y, 1e-9);
  }
}

// As in recordings with coordinates of a national grid.
TEST(MapFile, AMapFarFromTheOriginKeepsItsPlace) {
  const nodmap::test::TemporaryDir dir;
  OccupancyGrid grid(0.05);
  grid.add_ray({612345.6, 987654.3}, {612346.6, 987654.3});
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  const TrinaryGrid read = read_ros_map(dir.path());
  EXPECT_NEAR(read.T_map_grid.x, grid.origin().x(), 1e-6);
  EXPECT_NEAR(read.T_map_grid.y, grid.origin().y(), 1e-6);
}

// A folder under the name that a new file has until it is complete makes writing it fail. The two
// saves of the larger map end before the image is replaced, and between the image and map.yaml.
TEST(MapFile, AfterAnInterruptedSaveTheImageStillBelongsToTheYaml) {
  const nodmap::test::TemporaryDir dir;
  OccupancyGrid grid(0.5);
  ASSERT_TRUE(grid.add_ray({0.25, 0.25}, {0.25, 1.25}));
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  const TrinaryGrid old = read_ros_map(dir.path());
  ASSERT_TRUE(grid.add_ray({0.25, 0.25}, {0.25, -100.0}));  // moves the origin
  for (const char* name : {"map.pgm.part", "map.yaml.part"}) {
    std::filesystem::create_directory(dir.path() / name);
    EXPECT_TRUE(write_ros_map(dir.path(), grid)) << name;
    std::filesystem::remove(dir.path() / name);
    const TrinaryGrid read = read_ros_map(dir.path());
    EXPECT_EQ(read.cells, old.cells) << name;
    EXPECT_EQ(read.T_map_grid.y, old.T_map_grid.y) << name;
  }
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  const TrinaryGrid read = read_ros_map(dir.path());
  EXPECT_EQ(read.cells, trinary(grid).cells);
  EXPECT_LT(read.T_map_grid.y, old.T_map_grid.y);
  EXPECT_EQ(slurp(dir.path() / "map.yaml").find("image: map.pgm\n"), 0U);
  EXPECT_FALSE(std::filesystem::exists(dir.path() / "map.previous.pgm"));
}

// An image that cannot even be examined, here a link to itself, is replaced. On the thread that
// saves, an exception would end the process.
TEST(MapFile, AnImageThatCannotBeExaminedIsReplaced) {
  const nodmap::test::TemporaryDir dir;
  OccupancyGrid grid(0.5);
  ASSERT_TRUE(grid.add_ray({0.25, 0.25}, {0.25, 1.25}));
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  std::filesystem::remove(dir.path() / "map.pgm");
  std::filesystem::create_symlink("map.pgm", dir.path() / "map.pgm");
  ASSERT_TRUE(grid.add_ray({0.25, 0.25}, {0.25, -100.0}));  // map.yaml changes, too
  ASSERT_FALSE(write_ros_map(dir.path(), grid));
  EXPECT_EQ(read_ros_map(dir.path()).cells, trinary(grid).cells);
}

TEST(MapFile, APathThatCannotBeExaminedIsAnErrorOfTheUser) {
  const nodmap::test::TemporaryDir dir;
  std::filesystem::create_symlink("map.yaml", dir.path() / "map.yaml");
  EXPECT_THROW((void)read_ros_map(dir.path() / "map.yaml"), formats::InputFileError);
}

void put(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

// The map has features that only other programs write: pixels as text, comments, a rotated origin,
// and black for free.
TEST(MapFile, MapsOfOtherProgramsAreRead) {
  const nodmap::test::TemporaryDir dir;
  put(dir.path() / "hall.pgm",
      "P2 # made by hand\n# width and height\n3 2\n100\n0 50 100\n0 0 0\n");
  put(dir.path() / "hall.yaml",
      "image: hall.pgm\nresolution: 0.5\norigin: [1.0, 2.0, 1.5707963267948966]\nnegate: 1\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.25\n");
  const TrinaryGrid grid = read_ros_map(dir.path() / "hall.yaml");
  ASSERT_EQ(grid.cells.size(), 6U);
  EXPECT_EQ(grid.at(0, 0), CellState::kFree);
  EXPECT_EQ(grid.at(0, 1), CellState::kFree);  // the image's first row is on top
  EXPECT_EQ(grid.at(1, 1), CellState::kUnknown);
  EXPECT_EQ(grid.at(2, 1), CellState::kOccupied);
  EXPECT_EQ(grid.at(3, 1), CellState::kUnknown);
  EXPECT_NEAR(grid.middle_of(2, 0).x(), 1.0 - 0.25, 1e-9);
  EXPECT_NEAR(grid.middle_of(2, 0).y(), 2.0 + 1.25, 1e-9);
}

TEST(MapFile, TheErrorForAnUnreadableMapNamesTheFileAndTheReason) {
  const nodmap::test::TemporaryDir dir;
  const auto reason = [&](const std::string& yaml, const std::string& pgm) {
    put(dir.path() / "map.yaml", yaml);
    put(dir.path() / "map.pgm", pgm);
    try {
      (void)read_ros_map(dir.path());
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string good = "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  EXPECT_EQ(reason(good, "P5\n2 1\n255\nab"), "");
  EXPECT_NE(reason(good, "P5\n2 1\n255\na").find("map.pgm: an incomplete PGM image"),
            std::string::npos);
  EXPECT_NE(reason(good, "P5\n2 x").find("an incomplete PGM image"), std::string::npos);
  EXPECT_NE(reason(good, "P5\n200000 200000\n255\n").find("64 million"), std::string::npos);
  EXPECT_NE(reason(good, "P6\n1 1\n255\nabc").find("not a PGM image"), std::string::npos);
  EXPECT_NE(reason("image: none.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n", "").find("none.pgm"),
            std::string::npos);
  EXPECT_NE(reason("resolution: [", "").find("map.yaml"), std::string::npos);
  // Millimetres instead of metres; a map too fine to be read.
  for (const std::string resolution : {"-1", "0.00005", "50", ".nan", "5 cm"}) {
    EXPECT_NE(reason("image: map.pgm\nresolution: " + resolution + "\norigin: [0, 0, 0]\n", "")
                  .find("resolution: \"" + resolution + "\" is not a number from 0.005 to 1"),
              std::string::npos)
        << resolution;
  }
  EXPECT_NE(reason("", "").find("map.yaml: 'image' is missing"), std::string::npos);
  EXPECT_NE(reason("image: map.pgm\norigin: [0, 0, 0]\n", "").find("'resolution' is missing"),
            std::string::npos);
  EXPECT_NE(reason("image: map.pgm\nresolution: 0.1\n", "").find("'origin' is missing"),
            std::string::npos);
  for (const std::string origin : {"[5e8, 0, 0]", "[1, 2]", "[1, 2, x]", "3", "[0, 0, .inf]"}) {
    EXPECT_NE(reason("image: map.pgm\nresolution: 0.1\norigin: " + origin + "\n", "")
                  .find("map.yaml: origin: three numbers"),
              std::string::npos)
        << origin;
  }
  EXPECT_NE(reason(good + "occupied_thresh: 65%\n", "").find("\"65%\" is not a number from 0 to 1"),
            std::string::npos);
  EXPECT_NE(reason(good + "occupied_thresh: 0.2\nfree_thresh: 0.3\n", "").find("from 0 to 0.2"),
            std::string::npos);
  const std::string coarse = "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\n";
  EXPECT_NE(reason(coarse, "P5\n1000 1000\n255\n" + std::string(1'000'000, 'a')).find("m^2"),
            std::string::npos);
  EXPECT_NE(reason(coarse, "P5\n7000 1\n255\n" + std::string(7000, 'a')).find("6000 m"),
            std::string::npos);
}

TEST(MapFile, AFileOfAnotherKindIsRefusedWithTheOneThatIsNeeded) {
  for (const char* other : {"map.pgm", "keyframes.lcmlog"}) {
    try {
      (void)read_ros_map(other);
      FAIL() << other;
    } catch (const formats::InputFileError& error) {
      EXPECT_NE(std::string(error.what()).find("map.yaml is needed"), std::string::npos) << other;
    }
  }
}

TEST(MapFile, AMissingFolderIsAnError) {
  EXPECT_EQ(write_ros_map("/nonexistent/folder", OccupancyGrid(0.05)),
            std::errc::no_such_file_or_directory);
}

}  // namespace map_file_test
}  // namespace nodmap::slam2d
