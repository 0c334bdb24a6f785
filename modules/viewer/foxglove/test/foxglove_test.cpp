// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/foxglove.hpp"

#include <gtest/gtest.h>

#include <span>
#include <string>
#include <string_view>

namespace nodmap::foxglove {
namespace foxglove_test {

TEST(Foxglove, TimeIsSecondsAndNanoseconds) {
  EXPECT_EQ(time_json(time::from_utime(1'700'000'000'000'042)),
            Json({{"sec", 1'700'000'000}, {"nsec", 42'000}}));
  EXPECT_EQ(time_json(time::from_utime(-5)), Json({{"sec", 0}, {"nsec", 0}}));
}

TEST(Foxglove, InvalidUtf8GivesValidJson) {
  EXPECT_TRUE(Json::accept(to_text(Json({{"name", "\xFF\xFE slam"}}))));
}

std::string encoded(std::string_view text) {
  return base64(std::as_bytes(std::span(text)));
}

// RFC 4648, section 10.
TEST(Base64, AgreesWithTheVectorsOfTheRfc) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, EncodesEveryByte) {
  EXPECT_EQ(encoded("\xFF\xEF\xBE"), "/+++");
  EXPECT_EQ(encoded(std::string_view("\0\0\0", 3)), "AAAA");
}

}  // namespace foxglove_test
}  // namespace nodmap::foxglove
