// SPDX-License-Identifier: BSD-3-Clause
// A separate file, since the kernel's termios2 (rates as numbers) conflicts with <termios.h>.
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include "tests/support/pty_pair.hpp"

namespace nodmap::test {

int PtyPair::baud() const {
  termios2 attributes{};
  ::ioctl(terminal_, TCGETS2, &attributes);
  return static_cast<int>(attributes.c_ospeed);
}

}  // namespace nodmap::test
