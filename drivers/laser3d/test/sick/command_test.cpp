// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick/command.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace command_test {

using test::hex;
using test::telegram_of;

TEST(SickCommand, ModesAreAsInTheManual) {
  EXPECT_EQ(sick_command::set_mode(SickMode::kStreamAll), hex("02 00 02 00 20 24 34 08"));
  EXPECT_EQ(sick_command::set_mode(SickMode::kOnRequest), hex("02 00 02 00 20 25 35 08"));
  EXPECT_EQ(sick_command::set_mode(SickMode::kStreamInterlaced), hex("02 00 02 00 20 2A 3A 08"));
  EXPECT_EQ(sick_command::set_mode(SickMode::kInstallation),
            hex("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"));
}

TEST(SickCommand, RequestsAreAsInTheManual) {
  EXPECT_EQ(sick_command::request_config(), hex("02 00 01 00 74 50 12"));
}

TEST(SickCommand, BaudRatesAreAsInTheManual) {
  EXPECT_EQ(sick_command::set_baud(38400), hex("02 00 02 00 20 40 50 08"));
  EXPECT_EQ(sick_command::set_baud(19200), hex("02 00 02 00 20 41 51 08"));
  EXPECT_EQ(sick_command::set_baud(9600), hex("02 00 02 00 20 42 52 08"));
  EXPECT_EQ(sick_command::set_baud(500000), hex("02 00 02 00 20 48 58 08"));
}

TEST(SickCommand, VariantsAreAsInTheManual) {
  EXPECT_EQ(sick_command::set_variant(SickVariant::k180x100),
            hex("02 00 05 00 3B B4 00 64 00 97 49"));
  EXPECT_EQ(sick_command::set_variant(SickVariant::k180x050),
            hex("02 00 05 00 3B B4 00 32 00 3B 1F"));
  EXPECT_EQ(sick_command::set_variant(SickVariant::k100x100),
            hex("02 00 05 00 3B 64 00 64 00 1D 0F"));
  EXPECT_EQ(sick_command::set_variant(SickVariant::k100x050),
            hex("02 00 05 00 3B 64 00 32 00 B1 59"));
  EXPECT_EQ(sick_command::set_variant(SickVariant::k100x025),
            hex("02 00 05 00 3B 64 00 19 00 E7 72"));
}

TEST(SickCommand, ConfigurationsAreAsInTheManual) {
  EXPECT_EQ(sick_command::write_config({hex("00 00 46 00 00 00 01 00 00 02 02 02 00 00 0A 0A 50 64 "
                                            "00 0A 0A 50 80 00 0A 0A 50 64 00 00 00 00 02 00")}),
            hex("02 00 23 00 77 00 00 46 00 00 00 01 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 "
                "80 00 0A 0A 50 64 00 00 00 00 02 00 7B 4B"));
  EXPECT_EQ(sick_command::write_config({hex("00 00 70 00 02 06 01 00 00 02 02 00x21 02 00")}),
            hex("02 00 23 00 77 00 00 70 00 02 06 01 00 00 02 02 00x21 02 00 51 49"));
}

TEST(SickCommand, R1_GeometryOfEachVariant) {
  EXPECT_EQ(geometry_of(SickVariant::k180x100).num_values(), 181);
  EXPECT_EQ(geometry_of(SickVariant::k180x050).num_values(), 361);
  EXPECT_EQ(geometry_of(SickVariant::k100x100).num_values(), 101);
  EXPECT_EQ(geometry_of(SickVariant::k100x050).num_values(), 201);
  EXPECT_EQ(geometry_of(SickVariant::k100x025).num_values(), 401);
  EXPECT_EQ(geometry_of(SickVariant::k100x025).revolutions, 4);
}

using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used

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

TEST(SickConfig, OnlyTheDriversOwnSettingsAreChanged) {
  SickConfig before{hex("00 00 46 00 04 00 00 00 00 02 02 00x21 02 00")};
  const SickConfig after = with_measuring(before, SickUnit::kMillimetre, {0x06});
  EXPECT_EQ(after.bytes, hex("00 00 46 00 06 06 01 00 00 02 02 00x21 02 00"));
  EXPECT_EQ(with_measuring(after, SickUnit::kMillimetre, {0x06}), after);
}

}  // namespace command_test
}  // namespace nodmap::laser3d
