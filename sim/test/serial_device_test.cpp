// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/serial_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace serial_device_test {

using test::at;
using test::hex;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

Bytes all_bytes() {
  Bytes bytes;
  for (int i = 0; i < 256; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i));
  }
  return bytes;
}

TEST(Uart, SmallDifferencesOfTheBaudRateDoNoHarm) {
  // The last sample is 9.5 receiver bits after the edge and must be in the sender's stop bit: 9 <
  // 9.5 r < 10.
  for (const int baud : {96'000, 99'000, 100'000, 101'000, 104'000}) {
    EXPECT_THAT(received_bytes(100'000, all_bytes(), baud), ElementsAreArray(all_bytes())) << baud;
  }
  EXPECT_THAT(received_bytes(100'000, all_bytes(), 110'000),
              ::testing::Not(ElementsAreArray(all_bytes())));
}

// By hand: a receiver at half the rate samples at 3, 5, 7, ... of the sender's bit times, which are
// bits 2, 4, 6 and the stop bit, then those of the next byte.
TEST(Uart, AtHalfTheBaudRateEverySecondBitIsSampled) {
  // 0x54 has bits 2, 4 and 6 set; the sender's line is 0 00101010 1. The samples at 3, 5, 7 and 9
  // are 1, and so is the idle line after them.
  EXPECT_THAT(received_bytes(50'000, hex("54"), 100'000), ElementsAre(0xFF));
}

TEST(Uart, AFastReceiverReadsASlowZeroAsABreak) {
  // A zero at 9600 baud is nine low bits: for the receiver a break without a stop bit.
  EXPECT_THAT(received_bytes(500'000, hex("00"), 9600), ElementsAre(0x00));
  EXPECT_THAT(received_bytes(0, hex("00"), 9600), IsEmpty());
}

TEST(SerialOutput, BytesLeaveAtTheRateOfTheLine) {
  SerialOutput output;
  output.send(Bytes(372, 0x55), 500'000, at(1ms));
  EXPECT_EQ(output.idle_from(), at(1ms + 7440us)) << "372 bytes take 7.44 ms";
  Bytes line;
  output.take(at(1019us), 500'000, line);
  EXPECT_THAT(line, IsEmpty());
  output.take(at(1020us), 500'000, line);
  EXPECT_EQ(line.size(), 1U);
  output.take(at(1ms + 3720us), 500'000, line);
  EXPECT_EQ(line.size(), 186U);
  output.send(Bytes(1, 0x55), 500'000, at(2ms));
  EXPECT_EQ(output.idle_from(), at(1ms + 7460us)) << "sent one after the other";
  output.clear();
  EXPECT_EQ(output.next_due(), kNever);
}

}  // namespace serial_device_test
}  // namespace nodmap::sim
