// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/codec.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/support/allocations.hpp"

namespace nodmap::bus {
namespace codec_test {

using Bytes = std::vector<std::byte>;

nodmap::scan_t sample_scan() {
  nodmap::scan_t scan{};
  scan.utime = 123456789;
  scan.num_ranges = 5;
  scan.ranges_m = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  scan.num_intensities = 2;
  scan.intensities = {0.5F, 0.25F};
  return scan;
}

template <class Message>
Bytes encoded(const Message& message) {
  Bytes bytes;
  encode_into(bytes, message);
  return bytes;
}

// Offset of the number of ranges in an encoded scan: everything after it has a known size.
std::size_t offset_of_num_ranges(const nodmap::scan_t& scan) {
  return encoded(scan).size() - 4 * scan.intensities.size() - 4 - 4 * scan.ranges_m.size() - 4;
}

void put_int32(Bytes& bytes, std::size_t offset, std::int32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes.at(offset + i) =
        static_cast<std::byte>((static_cast<std::uint32_t>(value) >> (8 * (3 - i))) & 0xFFU);
  }
}

TEST(Codec, NumbersAreReadInNetworkByteOrder) {
  const Bytes bytes{std::byte{0x7F}, std::byte{0x01}, std::byte{0x02}, std::byte{0xFF},
                    std::byte{0xFF}, std::byte{0xFF}, std::byte{0xFE}};
  EXPECT_EQ(read_big_endian<std::uint16_t>(bytes, 1), 0x0102U);
  EXPECT_EQ(read_big_endian<std::uint32_t>(bytes), 0x7F0102FFU);
  EXPECT_EQ(read_big_endian<std::int32_t>(bytes, 3), -2);
}

TEST(Codec, RoundTripsEveryField) {
  nodmap::scan_t back{};
  ASSERT_TRUE(decode_into(back, encoded(sample_scan())));
  EXPECT_EQ(back.utime, 123456789);
  EXPECT_EQ(back.ranges_m, sample_scan().ranges_m);
  EXPECT_EQ(back.intensities, sample_scan().intensities);
  EXPECT_EQ(encoded(back), encoded(sample_scan()));
}

TEST(Codec, RoundTripsStringsAndTwoDimensions) {
  nodmap::status_t status{};
  status.process_name = "nodmap-slam2d";
  nodmap::status_t status_back{};
  ASSERT_TRUE(decode_into(status_back, encoded(status)));
  EXPECT_EQ(status_back.process_name, "nodmap-slam2d");
  EXPECT_EQ(status_back.health_reason, "");

  nodmap::cloud_chunk_t cloud{};
  cloud.num_points = 2;
  cloud.points_m = {{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}};
  nodmap::cloud_chunk_t cloud_back{};
  ASSERT_TRUE(decode_into(cloud_back, encoded(cloud)));
  EXPECT_EQ(cloud_back.points_m, cloud.points_m);
}

// lcm-gen's decoder leaves an array as it was when the count is 0.
TEST(Codec, AReusedMessageKeepsNothingOfTheLast) {
  nodmap::scan_t scan{};
  ASSERT_TRUE(decode_into(scan, encoded(sample_scan())));
  ASSERT_TRUE(decode_into(scan, encoded(nodmap::scan_t{})));
  EXPECT_TRUE(scan.ranges_m.empty());
  EXPECT_TRUE(scan.intensities.empty());
}

TEST(Codec, RefusesAnotherTypesFingerprint) {
  nodmap::odometry_t other{};
  EXPECT_FALSE(decode_into(other, encoded(sample_scan())));
}

TEST(Codec, RefusesEveryTruncationAndAnyTrailingByte) {
  const Bytes whole = encoded(sample_scan());
  nodmap::scan_t scan{};
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decode_into(scan, std::span(whole).first(size))) << size << " bytes";
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decode_into(scan, longer));
}

TEST(Codec, RefusesWrongCountsWithoutAllocatingForThem) {
  const std::size_t at = offset_of_num_ranges(sample_scan());
  for (const std::int32_t count : {-1, -2'000'000'000, 500'000'000, 2'147'483'647, 4, 6}) {
    Bytes bytes = encoded(sample_scan());
    put_int32(bytes, at, count);
    nodmap::scan_t scan{};
    test::reset_allocations();
    EXPECT_FALSE(decode_into(scan, bytes)) << count;
    // Memory must not be allocated for a claimed count, even if it is never used.
    EXPECT_LE(test::allocations().largest_bytes, bytes.size()) << count;
  }
}

TEST(Codec, RefusesStringsOfWrongLengthOrWithoutEnd) {
  nodmap::save_request_t request{};
  request.requested_by = "me";
  const std::size_t length_at = kFingerprintBytes + 8;
  for (const std::int32_t length : {0, -1, 2, 4, 1'000'000}) {
    Bytes bytes = encoded(request);
    put_int32(bytes, length_at, length);
    nodmap::save_request_t back{};
    EXPECT_FALSE(decode_into(back, bytes)) << length;
  }
  Bytes bytes = encoded(request);
  bytes.back() = std::byte{'x'};  // the closing zero
  nodmap::save_request_t back{};
  EXPECT_FALSE(decode_into(back, bytes));
}

TEST(Codec, SurvivesRandomBytes) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> byte(0, 255);
  std::uniform_int_distribution<std::size_t> size(0, 400);
  nodmap::scan_t scan{};
  int accepted = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes(size(random));
    for (std::byte& b : bytes) {
      b = static_cast<std::byte>(byte(random));
    }
    // Half of them have the right fingerprint, so that the layout check is reached.
    if (round % 2 == 0 && bytes.size() >= kFingerprintBytes) {
      const Bytes whole = encoded(sample_scan());
      std::copy_n(whole.begin(), kFingerprintBytes, bytes.begin());
    }
    accepted += decode_into(scan, bytes) ? 1 : 0;
  }
  // 200-odd bytes at random with two counts that add up: less likely than 1e-6 in all rounds
  // together.
  EXPECT_EQ(accepted, 0);
}

TEST(Codec, AFlippedBitIsRefusedOrChangesOnlyValues) {
  const Bytes whole = encoded(sample_scan());
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    nodmap::scan_t scan{};
    if (decode_into(scan, bytes)) {
      EXPECT_EQ(encoded(scan), bytes) << "bit " << bit;
    }
  }
}

}  // namespace codec_test
}  // namespace nodmap::bus
