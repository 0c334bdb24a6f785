// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"
#include "common/node/messages.hpp"

namespace nodmap::test {

/// Writes an artificial recording, message by message.
class Recording {
 public:
  explicit Recording(const std::filesystem::path& file) : writer_(file) {}

  void odometry(time::Timestamp stamp, const geometry::SE3& T_odom_base) {
    put(stamp, "ODOMETRY", node::write_odometry(stamp, T_odom_base));
  }

  void scan(const scan::Scan& scan) { put(scan.stamp, "SCAN", node::write_scan(scan)); }

  void bytes(time::Timestamp stamp, const std::string& channel, std::span<const std::byte> data) {
    EXPECT_TRUE(writer_.write(time::to_utime(stamp), channel, data));
  }

 private:
  template <class Message>
  void put(time::Timestamp stamp, const std::string& channel, const Message& message) {
    bus::encode_into(buffer_, message);
    bytes(stamp, channel, buffer_);
  }

  bus::LogWriter writer_;
  std::vector<std::byte> buffer_;
};

}  // namespace nodmap::test
