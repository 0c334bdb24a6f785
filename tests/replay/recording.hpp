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
#include "common/node/messages.hpp"

namespace nodmap::test {

/// Writes a made-up recording, message by message.
class Recording {
 public:
  explicit Recording(const std::filesystem::path& file) : writer_(file) {}

  void odometry(std::int64_t utime_us, const geometry::SE3& T_odom_base) {
    put(utime_us, "ODOMETRY", node::write_odometry(utime_us, T_odom_base));
  }

  void scan(const scan::Scan& scan) { put(scan.utime_us, "SCAN", node::write_scan(scan)); }

  void bytes(std::int64_t utime_us, const std::string& channel, std::span<const std::byte> data) {
    EXPECT_TRUE(writer_.write(utime_us, channel, data));
  }

 private:
  template <class Message>
  void put(std::int64_t utime_us, const std::string& channel, const Message& message) {
    bus::encode_into(buffer_, message);
    bytes(utime_us, channel, buffer_);
  }

  bus::LogWriter writer_;
  std::vector<std::byte> buffer_;
};

}  // namespace nodmap::test
