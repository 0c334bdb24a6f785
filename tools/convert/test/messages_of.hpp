// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::test {

/// Everything in a converted log.
struct Messages {
  std::vector<std::string> channels;
  std::vector<std::int64_t> log_utimes_us;
  std::vector<nodmap::odometry_t> odometry;
  std::vector<nodmap::scan_t> scans;
};

inline Messages messages_of(const std::filesystem::path& log) {
  Messages messages;
  bus::LogReader reader(log);
  while (const bus::LogEvent* event = reader.next()) {
    messages.channels.push_back(event->channel);
    messages.log_utimes_us.push_back(event->log_utime_us);
    if (event->channel == "SCAN") {
      EXPECT_TRUE(bus::decode_into(messages.scans.emplace_back(), event->data));
    } else {
      EXPECT_TRUE(bus::decode_into(messages.odometry.emplace_back(), event->data));
    }
  }
  return messages;
}

}  // namespace nodmap::test
