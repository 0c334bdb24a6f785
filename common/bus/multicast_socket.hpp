// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/bus/udpm_url.hpp"
#include "common/formats/file_descriptor.hpp"

namespace nodmap::bus {

/// Opens a socket that receives the group's datagrams, each with the kernel's time of arrival and
/// the number of datagrams dropped so far. Throws std::system_error.
[[nodiscard]] formats::FileDescriptor open_multicast_socket(const UdpmUrl& url);

}  // namespace nodmap::bus
