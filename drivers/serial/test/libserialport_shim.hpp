// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::test {

/// How often the modem lines of a pseudo-terminal were read. Only libserialport does that.
[[nodiscard]] int modem_line_reads();

}  // namespace nodmap::test
