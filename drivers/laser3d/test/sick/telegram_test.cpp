// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/telegram.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace telegram_test {

constexpr time::SteadyTime kStart{1s};

using test::hex;
using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used

std::vector<SickEvent> drain(SickParser& dut) {
  std::vector<SickEvent> events;
  while (auto event = dut.next()) {
    events.push_back(std::move(*event));
  }
  return events;
}

// Of the sensor.
const auto kGoldenTelegrams = std::to_array<const Bytes*>(
    {&test::kModeOk,         &test::kWrongPassword,  &test::kVariant180x100, &test::kVariant180x050,
     &test::kVariantRefused, &test::kResetDone,      &test::kNotAccepted,    &test::kNoErrors,
     &test::kModeOkFrom1,    &test::kPowerOn,        &test::kType,           &test::kConfig,
     &test::kConfigWritten,  &test::kThreeMm,        &test::kThreeMmIndexed, &test::kThreeCm,
     &test::kFlat181,        &test::kRamp181,        &test::kRamp181Indexed, &test::kFlat361,
     &test::kPartial50,      &test::kPartial50Marked});

std::vector<SickEvent> parse(const Bytes& bytes) {
  SickParser dut;
  dut.feed(bytes, kStart);
  return drain(dut);
}

std::vector<SickReply> replies(const std::vector<SickEvent>& events) {
  std::vector<SickReply> found;
  for (const SickEvent& event : events) {
    if (const auto* telegram = std::get_if<SickTelegram>(&event)) {
      found.push_back(telegram->reply);
    }
  }
  return found;
}

TEST(SickParser, ReadsEveryGoldenTelegram) {
  for (const Bytes* frame : kGoldenTelegrams) {
    const std::vector<SickEvent> events = parse(*frame);
    ASSERT_EQ(events.size(), 1U) << "reply " << int{(*frame)[4]};
    const auto& telegram = std::get<SickTelegram>(events.front());
    EXPECT_EQ(telegram.address, (*frame)[1]);
    EXPECT_EQ(static_cast<std::uint8_t>(telegram.reply), (*frame)[4]);
    EXPECT_EQ(telegram.data.size(), frame->size() - 8);
    EXPECT_EQ(telegram.status.severity(), 0);
    EXPECT_FALSE(telegram.status.polluted());
  }
}

TEST(SickParser, PiecesOfAnySizeGiveTheSameEvents) {
  const Bytes stream = hex("06") + test::kModeOk + test::kRamp181 + hex("15 06") + test::kType;
  std::mt19937 random(1);
  for (int run = 0; run < 200; ++run) {
    SickParser dut;
    std::vector<SickEvent> events;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t count =
          std::min(stream.size() - at, std::uniform_int_distribution<std::size_t>(1, 90)(random));
      dut.feed(ByteView(stream).subspan(at, count), kStart);
      for (SickEvent& event : drain(dut)) {
        events.push_back(std::move(event));
      }
      at += count;
    }
    ASSERT_EQ(events.size(), 6U);
    EXPECT_TRUE(std::holds_alternative<SickAck>(events[0]));
    EXPECT_TRUE(std::holds_alternative<SickNak>(events[3]));
    EXPECT_TRUE(std::holds_alternative<SickAck>(events[4]));
    EXPECT_EQ(replies(events),
              (std::vector{SickReply::kMode, SickReply::kMeasuredValues, SickReply::kType}));
    EXPECT_EQ(dut.errors().skipped_bytes, 0);
  }
}

TEST(SickParser, FindsATelegramInsideAFalseOne) {
  // A false start whose length spans two whole telegrams; both must be found.
  const Bytes false_start = hex("02 80 30 00 BA");
  const Bytes stream = false_start + test::kModeOk + test::kVariant180x100 + Bytes(60, 0x00);
  const std::vector<SickEvent> events = parse(stream);
  EXPECT_EQ(replies(events), (std::vector{SickReply::kMode, SickReply::kVariant}));
}

TEST(SickParser, StartBytesBeforeATelegramCostOnlyThemselves) {
  SickParser dut;
  dut.feed(hex("02 02 02 80 02 80") + test::kModeOk, kStart);
  EXPECT_EQ(replies(drain(dut)), std::vector{SickReply::kMode});
  EXPECT_EQ(dut.errors().skipped_bytes, 6);
}

TEST(SickParser, NoRandomNoiseHidesATelegramForLongerThanOneFrame) {
  std::mt19937 random(2);
  std::uniform_int_distribution<> byte(0, 255);
  for (int run = 0; run < 300; ++run) {
    Bytes stream;
    for (int i = 0; i < 50; ++i) {
      stream.push_back(static_cast<std::uint8_t>(byte(random)));
    }
    // After the noise three telegrams and enough bytes to finish any false frame.
    stream = stream + test::kRamp181 + test::kVariant180x100 + test::kFlat181;
    stream = stream + Bytes(SickParser::kMaxTelegramBytes, 0x00);
    EXPECT_EQ(replies(parse(stream)), (std::vector{SickReply::kMeasuredValues, SickReply::kVariant,
                                                   SickReply::kMeasuredValues}));
  }
}

TEST(SickParser, EverySingleWrongByteIsNoticed) {
  for (std::size_t at = 0; at < test::kThreeMmIndexed.size(); ++at) {
    Bytes damaged = test::kThreeMmIndexed;
    damaged[at] ^= 0x5A;
    EXPECT_TRUE(replies(parse(damaged)).empty()) << at;
  }
}

TEST(SickParser, ARequestCutsATelegramAndItsAnswerIsStillFound) {
  const Bytes cut(test::kRamp181.begin(), test::kRamp181.begin() + 100);
  SickParser dut;
  dut.feed(cut + hex("06") + test::kModeOk, kStart);
  EXPECT_TRUE(drain(dut).empty());  // still taken for the rest of the scan
  dut.expire(kStart + serial::FrameScanner::kExpiry + 1us);
  EXPECT_EQ(replies(drain(dut)), std::vector{SickReply::kMode});
  EXPECT_EQ(dut.errors().expired, 1);
}

TEST(SickParser, BytesFromBeforeASilenceDoNotJoinThoseFromAfter) {
  SickParser dut;
  dut.feed(ByteView(test::kModeOk).first(5), kStart);
  EXPECT_TRUE(drain(dut).empty());
  dut.feed(test::kModeOk, kStart + serial::FrameScanner::kExpiry + 1us);
  EXPECT_EQ(replies(drain(dut)), std::vector{SickReply::kMode});
}

TEST(SickParser, SlowLinesDoNotExpire) {
  SickParser dut;
  std::size_t telegrams = 0;
  for (std::size_t i = 0; i < test::kType.size(); ++i) {
    dut.feed(ByteView(test::kType).subspan(i, 1), kStart + i * 14ms);
    telegrams += drain(dut).size();
  }
  EXPECT_EQ(telegrams, 1U);
}

TEST(SickParser, ImplausibleTelegramsAreRefusedThoughTheirChecksumHolds) {
  EXPECT_TRUE(parse(test::sick_frame(hex("A0 00 00"))).empty());  // length of a reply
  EXPECT_TRUE(parse(test::sick_frame(hex("B0 03 80 01 00 02 00 03 00"))).empty());  // unit
  EXPECT_TRUE(parse(test::sick_frame(hex("B0 04 40 01 00 02 00 03 00"))).empty());  // count
  EXPECT_TRUE(parse(test::sick_frame(hex("B0 92 41") + test::ramp(402))).empty());  // too many
  EXPECT_TRUE(parse(test::sick_frame(hex("7F 00"))).empty());                       // no reply
}

TEST(SickParser, FirstByteIsDatedBackByTheLineRate) {
  SickParser dut(500000);
  dut.feed(test::kRamp181, kStart + 1s);  // 372 bytes of 20 us: the first came 371 bytes earlier
  const SickEvent event = *dut.next();
  EXPECT_EQ(std::get<SickTelegram>(event).first_byte, kStart + 1s - 371 * 20us);
}

TEST(SickParser, FirstByteIsThatOfItsOwnChunk) {
  SickParser dut(500000);
  dut.feed(ByteView(test::kRamp181).first(10), kStart + 5ms);
  EXPECT_FALSE(dut.next());
  dut.feed(ByteView(test::kRamp181).subspan(10), kStart + 90ms);
  const SickEvent event = *dut.next();
  EXPECT_EQ(std::get<SickTelegram>(event).first_byte, kStart + 5ms - 9 * 20us);
}

TEST(SickParser, AnAckInsideDamageIsIgnored) {
  EXPECT_TRUE(parse(hex("55 06 15 06")).empty());
}

std::uint16_t trailing_crc(const Bytes& frame) {
  return boost::endian::load_little_u16(&frame[frame.size() - 2]);
}

std::uint16_t computed_crc(const Bytes& frame) {
  return sick_crc(ByteView(frame).first(frame.size() - 2));
}

TEST(SickCrc, HoldsForEveryGoldenTelegramOfTheSensor) {
  for (const Bytes* frame : kGoldenTelegrams) {
    EXPECT_EQ(computed_crc(*frame), trailing_crc(*frame)) << "reply " << int{(*frame)[4]};
  }
}

TEST(SickCrc, NoticesEverySingleWrongByte) {
  Bytes frame = test::kConfig;
  const std::uint16_t crc = trailing_crc(frame);
  for (std::size_t at = 0; at + 2 < frame.size(); ++at) {
    for (unsigned error = 1; error < 256; ++error) {
      frame[at] ^= static_cast<std::uint8_t>(error);
      EXPECT_NE(computed_crc(frame), crc) << at << " " << error;
      frame[at] ^= static_cast<std::uint8_t>(error);
    }
  }
}

TEST(SickCrc, MissesAnErrorFollowedByItsDouble) {
  // The known weakness of the checksum, recorded here so that nobody relies on more than it can do.
  Bytes frame = test::kConfig;
  const std::uint16_t crc = trailing_crc(frame);
  frame[9] ^= 0x03;
  frame[10] ^= 0x06;
  EXPECT_EQ(computed_crc(frame), crc);
}

}  // namespace telegram_test
}  // namespace nodmap::laser3d
