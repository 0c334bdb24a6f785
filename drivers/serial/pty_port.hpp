// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/serial/serial_port.hpp"

namespace nodmap::serial {

/// Whether the (resolved) name is that of a pseudo-terminal.
[[nodiscard]] bool is_pty(const std::string& resolved_device);

/// Opens the terminal side of a pseudo-terminal; `settings.device` is its resolved name.
[[nodiscard]] OpenResult open_pty(const PortSettings& settings);

/// Takes the lock on an open device that every process of ours asks for; false when another has it.
/// The kernel gives it back when the holder dies, however that happens.
[[nodiscard]] bool lock_device(int fd);

}  // namespace nodmap::serial
