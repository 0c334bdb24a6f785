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
  EXPECT_EQ(parse_stamp("1.2345678"), time::from_utime(1'234'567));
}

TEST(Stamp, RefusesAnythingButADecimalNumber) {
  for (const char* text :
       {"", "-", ".", ".5", "1e9", "nan", "12:30", "1.2.3", "--1", "+1", "1 ", "1234567890123"}) {
    EXPECT_FALSE(parse_stamp(text)) << text;
  }
}

}  // namespace stamp_test
}  // namespace nodmap::formats
