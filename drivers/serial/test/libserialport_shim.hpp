// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::test {

/// How often somebody has asked a pseudo-terminal for its modem lines. Only libserialport does.
[[nodiscard]] int modem_line_reads();

}  // namespace nodmap::test
