// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/event_log.hpp"
#include "modules/logger/recorder.hpp"
#include "modules/logger/test/names_in.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/manual_clock.hpp"

namespace nodmap::logger::recorder_fixture {

inline constexpr std::int64_t kStartUs = 1'795'262'400'000'000;  // 2026-11-21 12:00:00 UTC
inline constexpr std::size_t kDataBytes = 968;  // with header and "DATA": 1000 bytes

/// A folder to record into, and a clock.
class RecorderFixture : public ::testing::Test {
 protected:
  // An event of 1000 bytes; its stamp is its number.
  void record(Recorder& recorder) {
    recorder.record(time::from_utime(num_recorded_++), "DATA", data_);
  }

  [[nodiscard]] std::vector<std::string> names() const {
    return names_in_folder::names_in(dir_.path());
  }

  // The stamps of the events in a file, which must contain nothing else.
  [[nodiscard]] std::vector<std::int64_t> stamps(const std::string& name) const {
    bus::LogReader reader(dir_.path() / name);
    std::vector<std::int64_t> found;
    while (const bus::LogEvent* event = reader.next()) {
      EXPECT_EQ(event->channel, "DATA");
      EXPECT_EQ(event->data.size(), kDataBytes);
      found.push_back(event->log_utime_us);
    }
    EXPECT_EQ(reader.skipped_bytes(), 0);
    return found;
  }

  test::TemporaryDir dir_;
  test::ManualClock clock_{time::from_utime(kStartUs)};
  std::vector<std::byte> data_{kDataBytes};
  std::int64_t num_recorded_ = 0;
};

}  // namespace nodmap::logger::recorder_fixture
