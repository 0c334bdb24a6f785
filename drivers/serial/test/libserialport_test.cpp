// SPDX-License-Identifier: BSD-3-Clause
// Checks that the other tests of this program do go through libserialport.
#include <gtest/gtest.h>

#include "drivers/serial/serial_port.hpp"
#include "drivers/serial/test/libserialport_shim.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::serial {
namespace libserialport_test {

TEST(Libserialport, OpensThePort) {
  const test::PtyPair pty;
  const int before = test::modem_line_reads();
  const OpenResult port = open_serial_port({pty.name(), 38400});
  ASSERT_NE(port.stream, nullptr) << port.error;
  EXPECT_GT(test::modem_line_reads(), before);
  EXPECT_EQ(pty.baud(), 38400);
}

// Rates without a constant of their own go through the kernel's BOTHER.
TEST(Libserialport, SetsAnyRate) {
  const test::PtyPair pty;
  const OpenResult port = open_serial_port({pty.name(), 123456});
  ASSERT_NE(port.stream, nullptr) << port.error;
  EXPECT_EQ(pty.baud(), 123456);
}

}  // namespace libserialport_test
}  // namespace nodmap::serial
