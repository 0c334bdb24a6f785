// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string_view>

namespace nodmap::formats {
namespace number_test {

TEST(ParseNumber, TakesTheWholeText) {
  EXPECT_EQ(parse_number<int>("-12"), -12);
  EXPECT_EQ(parse_number<std::uint16_t>("007"), 7);
  EXPECT_EQ(parse_number<double>("-1.5e3"), -1500.0);
  EXPECT_EQ(parse_number<double>(".5"), 0.5);
  for (const std::string_view text :
       {"", " ", "-", "1 ", " 1", "1\n", "+1", "1x", "0x10", "1,5", "1-2", "one"}) {
    EXPECT_EQ(parse_number<int>(text), std::nullopt) << "'" << text << "'";
    EXPECT_EQ(parse_number<double>(text), std::nullopt) << "'" << text << "'";
  }
  EXPECT_EQ(parse_number<int>("1.5"), std::nullopt);
  EXPECT_EQ(parse_number<int>(std::string_view("1\0", 2)), std::nullopt);
}

TEST(ParseNumber, RefusesWhatDoesNotFit) {
  EXPECT_EQ(parse_number<std::uint8_t>("255"), 255);
  EXPECT_EQ(parse_number<std::uint8_t>("256"), std::nullopt);
  EXPECT_EQ(parse_number<std::uint8_t>("-1"), std::nullopt);
  EXPECT_EQ(parse_number<double>("1e999"), std::nullopt);
}

// Whoever wants a finite number must check it.
TEST(ParseNumber, TakesNanAndInfinity) {
  EXPECT_TRUE(std::isnan(parse_number<double>("nan").value()));
  EXPECT_EQ(parse_number<double>("-inf"), -HUGE_VAL);
}

}  // namespace number_test
}  // namespace nodmap::formats
