// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/sick_crc.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

std::uint16_t trailing_crc(const Bytes& frame) {
  return read_u16(frame, frame.size() - 2);
}

std::uint16_t computed_crc(const Bytes& frame) {
  return sick_crc(ByteView(frame).first(frame.size() - 2));
}

TEST(SickCrc, HoldsForEveryGoldenTelegramOfTheSensor) {
  for (const Bytes* frame : {&test::kModeOk,         &test::kWrongPassword,  &test::kVariant180x100,
                             &test::kVariant180x050, &test::kVariantRefused, &test::kResetDone,
                             &test::kNotAccepted,    &test::kNoErrors,       &test::kModeOkFrom1,
                             &test::kPowerOn,        &test::kType,           &test::kConfig,
                             &test::kConfigWritten,  &test::kThreeMm,        &test::kThreeMmIndexed,
                             &test::kThreeCm,        &test::kFlat181,        &test::kRamp181,
                             &test::kRamp181Indexed, &test::kFlat361,        &test::kPartial50,
                             &test::kPartial50Marked}) {
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
  // The known weakness, pinned so that nobody takes the checksum for more than it is.
  Bytes frame = test::kConfig;
  const std::uint16_t crc = trailing_crc(frame);
  frame[9] ^= 0x03;
  frame[10] ^= 0x06;
  EXPECT_EQ(computed_crc(frame), crc);
}

}  // namespace
}  // namespace nodmap::laser3d
