// SPDX-License-Identifier: BSD-3-Clause
// A telegram from the line of a real LMS200.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "drivers/laser3d/sick/scan.hpp"
#include "drivers/laser3d/sick/telegram.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::laser3d {
namespace recording_test {

Bytes bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SickRecording, ChecksumHolds) {
  NODMAP_REQUIRE_DATA(file, "sick/lms200_scan_361.bin");
  const Bytes frame = bytes_of(file);
  ASSERT_EQ(frame.size(), 732U);
  EXPECT_EQ(boost::endian::load_little_u16(&frame[730]), 0x4764);
  EXPECT_EQ(sick_crc(ByteView(frame).first(730)), 0x4764);
}

TEST(SickRecording, IsARoom) {
  NODMAP_REQUIRE_DATA(file, "sick/lms200_scan_361.bin");
  SickParser parser;
  parser.feed(bytes_of(file), {});
  const auto event = parser.next();
  ASSERT_TRUE(event);
  const SickScan scan = *read_scan(std::get<SickTelegram>(*event), {0x06});
  ASSERT_EQ(scan.ranges_m.size(), 361U);
  EXPECT_FLOAT_EQ(scan.ranges_m[0], 2.251F);  // CB 08
  int pairs = 0;
  int edges = 0;
  for (std::size_t i = 1; i < 361; ++i) {
    if (std::isfinite(scan.ranges_m[i]) && std::isfinite(scan.ranges_m[i - 1])) {
      ++pairs;
      edges += std::abs(scan.ranges_m[i] - scan.ranges_m[i - 1]) > 0.2F ? 1 : 0;
    }
  }
  EXPECT_EQ(pairs, 360);
  EXPECT_LT(edges, pairs / 10);  // walls are smooth: read wrongly, most neighbours differ
}

}  // namespace recording_test
}  // namespace nodmap::laser3d
