// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

namespace nodmap::kurt {
namespace slcan_test {

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> data, bool extended = false) {
  CanFrame f;
  f.id = id;
  f.extended = extended;
  f.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, f.data.begin());
  return f;
}

CanFrame remote(std::uint32_t id, std::uint8_t length, bool extended = false) {
  CanFrame f = frame(id, {}, extended);
  f.remote = true;
  f.length = length;
  return f;
}

std::vector<SlcanLine> parse(SlcanParser& parser, const std::string& text) {
  std::vector<SlcanLine> lines;
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  parser.push(bytes, [&lines](const SlcanLine& line) { lines.push_back(line); });
  return lines;
}

// Lines as they stand in the manuals of adapter and base.
const std::vector<std::pair<std::string, CanFrame>> kGolden{
    {"t001800000103FF0103FF", frame(1, {0x00, 0x00, 0x01, 0x03, 0xFF, 0x01, 0x03, 0xFF})},
    {"t00180002003200320001", frame(1, {0x00, 0x02, 0x00, 0x32, 0x00, 0x32, 0x00, 0x01})},
    {"t00180002FFEC00140001", frame(1, {0x00, 0x02, 0xFF, 0xEC, 0x00, 0x14, 0x00, 0x01})},
    {"t00180002000000000001", frame(1, {0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01})},
    {"t0018FFFF000000000000", frame(1, {0xFF, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00})},
    {"t08080051000000000000", frame(0x80, {0x00, 0x51, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00})},
    {"t00980064FF9C00000000", frame(9, {0x00, 0x64, 0xFF, 0x9C, 0x00, 0x00, 0x00, 0x00})},
    {"t1230", frame(0x123, {})},
    {"t4563112233", frame(0x456, {0x11, 0x22, 0x33})},
    {"T12ABCDEF2AA55", frame(0x12ABCDEF, {0xAA, 0x55}, true)},
    {"r1230", remote(0x123, 0)},
    {"r1238", remote(0x123, 8)},
    {"R12ABCDEF2", remote(0x12ABCDEF, 2, true)},
    {"T1111222281122334455667788",
     frame(0x11112222, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}, true)},
};

TEST(Slcan, GoldenLinesBothWays) {
  for (const auto& [line, expected] : kGolden) {
    EXPECT_EQ(to_line(expected), line + "\r");
    const auto parsed = parse_frame(line);
    ASSERT_TRUE(parsed.has_value()) << line;
    EXPECT_EQ(*parsed, expected) << line;
  }
}

TEST(Slcan, StampsOfTheAdapterAreRead) {
  const auto parsed = parse_frame("t00980064FF9C0000000004D2");
  ASSERT_TRUE(parsed.has_value());
  EXPECT_EQ(parsed->stamp_ms, 1234);
  EXPECT_EQ(parse_frame("T1111222281122334455667788EA5F")->stamp_ms, 59'999);  // the longest line
  EXPECT_EQ(parse_frame("t1230EA5F")->stamp_ms, 59'999);
  EXPECT_FALSE(parse_frame("t1230EA60").has_value());  // beyond the adapter's minute
}

TEST(Slcan, LowerCaseIsHexadecimalToo) {
  EXPECT_EQ(parse_frame("T12abcdef2aa55"), frame(0x12ABCDEF, {0xAA, 0x55}, true));
}

TEST(Slcan, InvalidFramesAreRefused) {
  for (const char* line : {"",
                           "t",
                           "t12",
                           "t123",
                           "t12300",
                           "t1231",
                           "t12311",
                           "t123111G",
                           "t1239112233445566778899",
                           "t123A",
                           "tG230",
                           "t8000",
                           "T2FFFFFFF0",
                           "T200000000",
                           "t1230 ",
                           "t12300000000",
                           "x1230",
                           "t-120",
                           "t1 30",
                           "r12381122334455667788"}) {
    EXPECT_FALSE(parse_frame(line).has_value()) << line;
  }
}

TEST(SlcanParser, DistinguishesFramesAnswersAndFlags) {
  using Kind = SlcanLine::Kind;
  SlcanParser parser;
  const auto lines = parse(parser, "\r\az\rZ\rt1230\rF85\rV1013\r");
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_EQ(lines[0].kind, Kind::kDone);
  EXPECT_EQ(lines[1].kind, Kind::kRefused);
  EXPECT_EQ(lines[2].kind, Kind::kDone);
  EXPECT_EQ(lines[3].kind, Kind::kDone);
  EXPECT_EQ(lines[4].kind, Kind::kFrame);
  EXPECT_EQ(lines[4].frame, frame(0x123, {}));
  EXPECT_EQ(lines[5].kind, Kind::kFlags);
  EXPECT_EQ(lines[5].flags, kReceiveQueueFull | kErrorWarning | kBusError);
  EXPECT_EQ(lines[6].kind, Kind::kVersion);
  EXPECT_EQ(parser.counts().done, 3);
  EXPECT_EQ(parser.counts().refused, 1);
  EXPECT_EQ(parser.counts().frames, 1);
}

// As some clones do: the next line is one of the base.
TEST(SlcanParser, AnAcknowledgementNeedsNoLineEnd) {
  SlcanParser parser;
  const auto lines = parse(parser, "zt1230\rzZT1111222281122334455667788EA5F\rz\rt1230\rz\a");
  ASSERT_EQ(lines.size(), 9U);
  EXPECT_EQ(lines[0].kind, SlcanLine::Kind::kDone);
  EXPECT_EQ(lines[1].frame, frame(0x123, {}));
  EXPECT_EQ(lines[4].frame.id, 0x11112222U) << "the longest line";
  EXPECT_EQ(lines[8].kind, SlcanLine::Kind::kRefused);
  EXPECT_EQ(parser.counts().done, 5);
  EXPECT_EQ(parser.counts().frames, 3);
  EXPECT_EQ(parser.counts().refused, 1);
  EXPECT_EQ(parser.counts().unknown + parser.counts().malformed, 0);
  EXPECT_EQ(parse(parser, "z").size(), 1U) << "at once, not with the next line";
}

TEST(SlcanParser, BellEndsALine) {
  SlcanParser parser;
  EXPECT_EQ(parse(parser, "t1230\a").size(), 1U);
  EXPECT_EQ(parser.counts().frames, 1);
  EXPECT_EQ(parser.counts().refused, 0);
}

TEST(SlcanParser, DropsAndCountsByCause) {
  SlcanParser parser;
  EXPECT_TRUE(parse(parser, "t12\rt1239112233445566778899\rt123111G\rFxx\rF\rF8501\r").empty());
  EXPECT_EQ(parser.counts().malformed, 6);
  EXPECT_TRUE(parse(parser, "V\rN4242\rsa01\re1a00\r").empty());
  EXPECT_EQ(parser.counts().unknown, 4);
  EXPECT_TRUE(parse(parser, "T1111222281122334455667788EA5F0\r").empty());  // one too long
  EXPECT_EQ(parser.counts().too_long, 1);
  // A lost line end joins two lines: both are lost, the next one is not.
  std::string glued(100, 't');
  glued.append("\rt1230\r");
  EXPECT_EQ(parse(parser, glued).size(), 1U);
  EXPECT_EQ(parser.counts().too_long, 2);
}

TEST(SlcanParser, LinesInPiecesGiveTheSameFrames) {
  std::string text;
  for (const auto& [line, expected] : kGolden) {
    text += line + "\r";
  }
  SlcanParser whole;
  const auto lines = parse(whole, text);
  ASSERT_EQ(lines.size(), kGolden.size());
  SlcanParser pieces;
  std::size_t seen = 0;
  for (const char c : text) {
    for (const SlcanLine& line : parse(pieces, std::string(1, c))) {
      EXPECT_EQ(line.frame, kGolden[seen++].second);
    }
  }
  EXPECT_EQ(seen, kGolden.size());
}

TEST(SlcanParser, AfterARestartALineBegunIsForgotten) {
  SlcanParser parser;
  parse(parser, "t12");
  parser.restart();
  EXPECT_EQ(parse(parser, "t4563112233\r").at(0).frame.id, 0x456U);
}

// Whatever arrives, every line and every acknowledgement without an end is counted exactly once,
// and valid lines get through.
TEST(SlcanParser, NoiseIsSurvivedAndCounted) {
  std::mt19937 random(5);
  SlcanParser parser;
  std::string text;
  const std::string letters = "tTrRzZF0123456789abcdefABCDEF\r\a\n \xFF";
  for (int i = 0; i < 200'000; ++i) {
    text += letters[random() % letters.size()];
  }
  // A z or Z counts where a line begins; the CR after it does not.
  std::int64_t ends = 0;
  bool begins = true;
  bool acknowledged = false;
  for (const char c : text) {
    const bool is_end = c == '\r' || c == '\a';
    const bool acknowledges = begins && (c == 'z' || c == 'Z');
    ends += (is_end && !(acknowledged && c == '\r')) || acknowledges ? 1 : 0;
    begins = is_end || acknowledges;
    acknowledged = acknowledges;
  }
  std::int64_t flags = 0;
  for (const SlcanLine& line : parse(parser, text)) {
    flags += line.kind == SlcanLine::Kind::kFlags ? 1 : 0;
  }
  const SlcanCounts& c = parser.counts();
  EXPECT_EQ(c.frames + c.done + c.refused + c.malformed + c.too_long + c.unknown + flags, ends);
  EXPECT_GT(c.malformed, 0);
  EXPECT_EQ(parse(parser, "\rt1230\r").back().frame, frame(0x123, {}));
}

}  // namespace slcan_test
}  // namespace nodmap::kurt
