// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/stamp.hpp"

#include <gtest/gtest.h>

namespace nodmap::formats {
namespace stamp_test {

TEST(Stamp, IsExactToTheMicrosecond) {
  EXPECT_EQ(parse_stamp("976052857.337284"), time::from_utime(976052857337284));
  EXPECT_EQ(parse_stamp("0.000001"), time::from_utime(1));
  EXPECT_EQ(parse_stamp("1.5"), time::from_utime(1'500'000));
  EXPECT_EQ(parse_stamp("7"), time::from_utime(7'000'000));
  EXPECT_EQ(parse_stamp("7."), time::from_utime(7'000'000));
  EXPECT_EQ(parse_stamp("-0.25"), time::from_utime(-250'000));
}

TEST(Stamp, IsRounded) {
  EXPECT_EQ(parse_stamp("1.2345678"), time::from_utime(1'234'568));
  EXPECT_EQ(parse_stamp("-1.2345678"), time::from_utime(-1'234'568));
  EXPECT_EQ(parse_stamp("1.2345674"), time::from_utime(1'234'567));
  EXPECT_EQ(parse_stamp("1.9999999"), time::from_utime(2'000'000));
  EXPECT_EQ(parse_stamp("9.760528573372839689e+08"), time::from_utime(976052857337284));
}

TEST(Stamp, IsAsExactWithAnExponent) {
  EXPECT_EQ(parse_stamp("1.311868164363960028e+09"), time::from_utime(1311868164363960));
  EXPECT_EQ(parse_stamp("-9.76052857337284E8"), time::from_utime(-976052857337284));
  EXPECT_EQ(parse_stamp("1e9"), time::from_utime(1'000'000'000'000'000));
  EXPECT_EQ(parse_stamp("123456.5e-3"), time::from_utime(123'456'500));
  EXPECT_EQ(parse_stamp("7.25e-06"), time::from_utime(7));
  EXPECT_EQ(parse_stamp("7.25e-7"), time::from_utime(1));
  EXPECT_EQ(parse_stamp("4.25e-7"), time::from_utime(0));
  EXPECT_EQ(parse_stamp("7.25e-12"), time::from_utime(0));
  EXPECT_EQ(parse_stamp("0.000000000000000000e+00"), time::from_utime(0));
}

TEST(Stamp, RefusesAnythingButADecimalNumber) {
  for (const char* text :
       {"",     "-",    ".",     ".5",    "nan",   "12:30",         "1.2.3",
        "--1",  "+1",   "1 ",    "1e",    "e9",    "1e+",           "1e+-3",
        "1e99", "1e13", "1e1e1", "1e1.5", "12e12", "1234567890123", "1e9999999999"}) {
    EXPECT_FALSE(parse_stamp(text)) << text;
  }
}

}  // namespace stamp_test
}  // namespace nodmap::formats
