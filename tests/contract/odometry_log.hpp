// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "nodmap/odometry_t.hpp"

namespace nodmap::test {

/// Writes a log of this many messages of a stationary robot, which every module uses.
inline void write_odometry_log(const std::filesystem::path& file, int num_messages) {
  bus::LogWriter log(file);
  std::vector<std::byte> bytes;
  for (int i = 0; i < num_messages; ++i) {
    nodmap::odometry_t message{};
    message.utime = i;
    message.orientation[0] = 1.0;
    bus::encode_into(bytes, message);
    ASSERT_TRUE(log.write(i, "ODOMETRY", bytes));
  }
}

}  // namespace nodmap::test
