// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "drivers/serial/byte_stream.hpp"

namespace nodmap::serial {

/// A line with 8 data bits, no parity, 1 stop bit and no flow control, as all our devices use.
struct PortSettings {
  std::string device;  ///< /dev/ttyUSB0, or a link such as /dev/serial/by-id/...
  int baud = 115200;   ///< bit/s
};

struct OpenResult {
  std::unique_ptr<ByteStream> stream;  ///< null when it could not be opened
  std::string error;                   ///< why it could not be opened, with what to try
};

/// Opens a port for exclusive use: a second open, by this or another process, is refused. Links are
/// resolved at each call, so that a device that comes back under another name is found.
///
/// Serial ports are opened and configured by libserialport. It does not accept a pseudo-terminal
/// (/dev/pts/N: a simulated device), which has no modem lines; this is opened as a plain terminal
/// and behaves the same afterwards.
[[nodiscard]] OpenResult open_serial_port(const PortSettings& settings);

}  // namespace nodmap::serial
