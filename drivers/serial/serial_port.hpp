// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "drivers/serial/byte_stream.hpp"

namespace nodmap::serial {

/// A line with 8 data bits, no parity, 1 stop bit and no flow control: what all our devices speak.
struct PortSettings {
  std::string device;               ///< /dev/ttyUSB0, or a link such as /dev/serial/by-id/...
  int baud = 115200;                ///< bit/s
  const StopEvent* stop = nullptr;  ///< ends a waiting read; must outlive the stream
};

struct OpenResult {
  std::unique_ptr<ByteStream> stream;  ///< null when it could not be opened
  std::string error;                   ///< then why, with what to try
};

/// Opens for this process alone: a second open, from here or elsewhere, is refused. Links are
/// followed anew each time, so that a device that comes back under another name is found.
///
/// Serial ports are opened and configured by libserialport. A pseudo-terminal (/dev/pts/N: a
/// simulated device) has no modem lines and is none of the ports libserialport knows; it is opened
/// as the plain terminal that it is, and behaves the same from there on.
[[nodiscard]] OpenResult open_serial_port(const PortSettings& settings);

}  // namespace nodmap::serial
