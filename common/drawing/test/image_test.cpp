// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/image.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <random>
#include <stdexcept>

#include "tests/support/data_dir.hpp"

namespace nodmap::drawing {
namespace image_test {

constexpr Rgb kRed{255, 0, 0};

TEST(Image, DrawsInsideAndCutsOutside) {
  Image image(10, 5);
  image.set(3, 2, kRed);
  image.set(-1, 0, kRed);
  image.set(10, 0, kRed);
  EXPECT_EQ(image.at(3, 2), kRed);
  EXPECT_EQ(image.at(0, 0), kWhite);
  image.draw_line(-100, 4, 100, 4, kRed);
  EXPECT_EQ(image.at(0, 4), kRed);
  EXPECT_EQ(image.at(9, 4), kRed);
  image.fill_rectangle(8, 0, 100, 1, kRed);
  EXPECT_EQ(image.at(9, 0), kRed);
  EXPECT_EQ(image.at(7, 0), kWhite);
}

TEST(Image, SurvivesCoordinatesThatAreNotFinite) {
  Image image(4, 4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  image.draw_line(nan, 0, 1, 1, kRed);
  image.fill_disc(nan, nan, 3, kRed);
  image.draw_line(0, 0, std::numeric_limits<double>::infinity(), 0, kRed);
  EXPECT_EQ(image.at(2, 2), kWhite);
}

// Oracle: libpng reads back what was written.
TEST(Image, PngReadsBack) {
  const test::TemporaryDir dir;
  Image image(3, 2);
  image.set(2, 1, kRed);
  image.write_png(dir.path() / "a.png");
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, (dir.path() / "a.png").c_str()), 0);
  ASSERT_EQ(header.width, 3U);
  ASSERT_EQ(header.height, 2U);
  header.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(18);
  ASSERT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(pixels[15], 255);
  EXPECT_EQ(pixels[16], 0);
  EXPECT_EQ(pixels[0], 255);
  EXPECT_EQ(pixels[1], 255);
  EXPECT_THROW(image.write_png(dir.path() / "no" / "such" / "a.png"), std::runtime_error);
}

TEST(Image, SaysThatTheDiskIsFull) {
  const test::TemporaryDir dir;
  const std::filesystem::path file = dir.path() / "a.png";
  std::filesystem::create_symlink("/dev/full", file);  // libpng removes what it could not complete
  Image image(100, 100);
  std::mt19937 random(1);  // noise, because less than a buffer fails otherwise
  for (int i = 0; i < 10'000; ++i) {
    image.set(i % 100, i / 100, {static_cast<std::uint8_t>(random()), 0, 0});
  }
  try {
    image.write_png(file);
    FAIL() << "nothing can be written there";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), file.string() + ": cannot write: No space left on device");
  }
}

TEST(ColourScale, HasItsEndColoursAndClampsValuesOutside) {
  EXPECT_EQ(colour_scale(0.0), (Rgb{68, 1, 84}));
  EXPECT_EQ(colour_scale(1.0), (Rgb{253, 231, 37}));
  EXPECT_EQ(colour_scale(-5.0), colour_scale(0.0));
  EXPECT_EQ(colour_scale(std::numeric_limits<double>::quiet_NaN()), colour_scale(0.0));
}

}  // namespace image_test
}  // namespace nodmap::drawing
