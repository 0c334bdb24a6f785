// SPDX-License-Identifier: BSD-3-Clause
// A file of its own: the kernel's termios2, with rates as numbers, and <termios.h> do not mix.
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
