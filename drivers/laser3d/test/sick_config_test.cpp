// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_config.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

using test::hex;
using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used

SickTelegram telegram_of(const Bytes& bytes) {
  SickParser parser;
  parser.feed(bytes, 0);
  const auto event = parser.next();
  return event ? std::get<SickTelegram>(*event) : SickTelegram{};
}

TEST(SickConfig, ReadsBothAnswers) {
  const auto read = read_config(telegram_of(test::kConfig));
  const auto written = read_config(telegram_of(test::kConfigWritten));
  ASSERT_TRUE(read);
  EXPECT_EQ(read, written);
  EXPECT_EQ(read->measuring_mode().value, 0x06);
  EXPECT_EQ(read->unit(), SickUnit::kMillimetre);
  EXPECT_TRUE(read->sends_indices());
}

TEST(SickConfig, ARefusedWriteIsNoConfiguration) {
  Bytes refused = hex("F7 00") + Bytes(34, 0x00);
  EXPECT_FALSE(read_config(telegram_of(test::sick_frame(refused))));
  EXPECT_FALSE(read_config(telegram_of(test::kModeOk)));
}

TEST(SickConfig, OldFirmwareHasTwoBytesLess) {
  const Bytes frame = test::sick_frame(hex("F4 00 00 46 00 00 00 01") + Bytes(25, 0x00));
  const auto config = read_config(telegram_of(frame));
  ASSERT_TRUE(config);
  EXPECT_EQ(config->bytes.size(), 32U);
}

TEST(SickConfig, OnlyWhatTheDriverDecidesIsChanged) {
  SickConfig before{hex("00 00 46 00 04 00 00 00 00 02 02 00x21 02 00")};
  const SickConfig after = with_measuring(before, SickUnit::kMillimetre, {0x06});
  EXPECT_EQ(after.bytes, hex("00 00 46 00 06 06 01 00 00 02 02 00x21 02 00"));
  EXPECT_EQ(with_measuring(after, SickUnit::kMillimetre, {0x06}), after);
}

}  // namespace
}  // namespace nodmap::laser3d
