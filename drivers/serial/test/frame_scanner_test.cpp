// SPDX-License-Identifier: BSD-3-Clause
// The scanner with the simplest format there is: '<', the number of bytes of the content as a
// digit, the content, and its sum modulo 256. The formats of the devices are tested with their
// drivers.
#include "drivers/serial/frame_scanner.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <string>

namespace nodmap::serial {
namespace frame_scanner_test {

FrameStart start(ByteView bytes, bool /*in_step*/) {
  using Kind = FrameStart::Kind;
  if (bytes[0] != '<') {
    return {Kind::kNone};
  }
  if (bytes.size() < 2) {
    return {Kind::kPlausible, 2};
  }
  if (bytes[1] < '0' || bytes[1] > '9') {
    return {Kind::kImplausible};
  }
  return {Kind::kPlausible, 3U + bytes[1] - '0'};
}

std::uint8_t sum_of(ByteView content) {
  return static_cast<std::uint8_t>(std::accumulate(content.begin(), content.end(), 0));
}

bool checksum_holds(ByteView frame) {
  return sum_of(frame.subspan(2, frame.size() - 3)) == frame.back();
}

constexpr time::SteadyTime kStart;
constexpr FrameFormat kFormat{start, checksum_holds};

Bytes framed(const std::string& content) {
  Bytes bytes{'<', static_cast<std::uint8_t>('0' + content.size())};
  for (const char c : content) {
    bytes.push_back(static_cast<std::uint8_t>(c));
  }
  bytes.push_back(sum_of(ByteView(bytes).subspan(2)));
  return bytes;
}

Bytes operator+(Bytes a, const Bytes& b) {
  append(a, b);
  return a;
}

// The contents of all complete frames.
std::vector<std::string> drain(FrameScanner& scanner) {
  std::vector<std::string> contents;
  while (const auto frame = scanner.next()) {
    contents.emplace_back(frame->bytes.begin() + 2, frame->bytes.end() - 1);
  }
  return contents;
}

TEST(FrameScanner, FindsTheSameFramesInPiecesOfAnySize) {
  const Bytes stream = framed("one") + Bytes{'#', '<', 'x'} + framed("two") + framed("");
  std::mt19937 random(1);
  for (int run = 0; run < 200; ++run) {
    FrameScanner scanner(kFormat, 9600);
    std::vector<std::string> found;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t count =
          std::min(stream.size() - at, std::uniform_int_distribution<std::size_t>(1, 6)(random));
      scanner.feed(ByteView(stream).subspan(at, count), kStart);
      for (std::string& content : drain(scanner)) {
        found.push_back(std::move(content));
      }
      at += count;
    }
    EXPECT_EQ(found, (std::vector<std::string>{"one", "two", ""}));
    EXPECT_EQ(scanner.errors().skipped_bytes, 3);
    EXPECT_EQ(scanner.errors().implausible, 1);
  }
}

TEST(FrameScanner, FindsAWholeFrameInsideAFalseStart) {
  FrameScanner scanner(kFormat, 9600);
  scanner.feed(Bytes{'<', '5'} + framed("a") + Bytes{'#', '#'}, kStart);
  EXPECT_EQ(drain(scanner), std::vector<std::string>{"a"});
  EXPECT_EQ(scanner.errors().checksum, 1);
}

TEST(FrameScanner, BytesFromBeforeASilenceDoNotJoinThoseFromAfter) {
  FrameScanner scanner(kFormat, 9600);
  scanner.feed(ByteView(framed("cut")).first(3), kStart);
  EXPECT_TRUE(drain(scanner).empty());
  scanner.feed(framed("new"), kStart + FrameScanner::kExpiry + 1us);
  EXPECT_EQ(drain(scanner), std::vector<std::string>{"new"});
  EXPECT_EQ(scanner.errors().expired, 1);
}

TEST(FrameScanner, AfterASilenceAFrameHiddenByAFalseStartIsFound) {
  FrameScanner scanner(kFormat, 9600);
  scanner.feed(Bytes{'<', '9'} + framed("a"), kStart);
  EXPECT_TRUE(drain(scanner).empty()) << "it may still be the start of nine bytes";
  scanner.expire(kStart + FrameScanner::kExpiry + 1us);
  EXPECT_EQ(drain(scanner), std::vector<std::string>{"a"});
}

TEST(FrameScanner, TheFirstByteIsDatedBackByTheRateOfTheLine) {
  FrameScanner scanner(kFormat, 10'000);  // 1 ms a byte
  scanner.feed(framed("abc") + framed("d"), kStart + 100ms);
  EXPECT_EQ(scanner.next()->first_byte, kStart + 91ms);
  EXPECT_EQ(scanner.next()->first_byte, kStart + 97ms);
}

TEST(FrameScanner, ANewRateForgetsReceivedBytes) {
  FrameScanner scanner(kFormat, 9600);
  scanner.feed(ByteView(framed("old")).first(3), kStart);
  scanner.reset(500'000);
  scanner.feed(framed("new"), kStart);
  EXPECT_EQ(drain(scanner), std::vector<std::string>{"new"});
  EXPECT_EQ(scanner.errors().skipped_bytes, 0);
}

}  // namespace frame_scanner_test
}  // namespace nodmap::serial
