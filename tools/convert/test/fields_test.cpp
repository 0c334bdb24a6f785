// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nodmap::convert {
namespace fields_test {

TEST(Fields, ReadsWordByWord) {
  Fields fields("  NAME 1.5\t-2e1 3 1071078718.462310 inf 1 2 3\r");
  EXPECT_EQ(fields.word(), "NAME");
  EXPECT_EQ(fields.number(), 1.5);
  EXPECT_EQ(fields.finite(), -20.0);
  EXPECT_EQ(fields.count(), 3U);
  EXPECT_EQ(fields.stamp(), time::from_utime(1071078718462310));
  EXPECT_EQ(fields.number(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(fields.numbers(3), (std::vector<float>{1.0F, 2.0F, 3.0F}));
  EXPECT_TRUE(fields.at_end());
  EXPECT_TRUE(fields.ok());
}

TEST(Fields, RemembersAFailure) {
  for (const char* line : {"", "x", "1x", "1,5", "0x10", "--1"}) {
    Fields fields(line);
    EXPECT_EQ(fields.number(), 0.0) << line;
    EXPECT_FALSE(fields.ok()) << line;
  }
  Fields fields("x 1");
  fields.number();
  EXPECT_EQ(fields.number(), 0.0);
  EXPECT_FALSE(fields.ok());
}

TEST(Fields, FiniteAndCountRefuseOtherNumbers) {
  for (const char* line : {"nan", "inf", "-inf"}) {
    Fields fields(line);
    fields.finite();
    EXPECT_FALSE(fields.ok()) << line;
  }
  for (const char* line : {"-1", "1.5", "99999999999999999999999"}) {
    Fields fields(line);
    EXPECT_EQ(fields.count(), 0U) << line;
    EXPECT_FALSE(fields.ok()) << line;
  }
}

TEST(Fields, DamagedCountCostsNoMemory) {
  Fields fields("18446744073709551615 1 2 3");
  const auto values = fields.numbers(fields.count());
  EXPECT_FALSE(fields.ok());
  EXPECT_LT(values.capacity(), 100U);
}

}  // namespace fields_test
}  // namespace nodmap::convert
