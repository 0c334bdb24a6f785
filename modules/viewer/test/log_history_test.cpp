// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/log_history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/status_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::viewer {
namespace log_history_test {

TEST(Series, KeepsTheExtremesOfEachInterval) {
  Series series(10.0, 5.0);
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) {
    values.push_back(std::sin(0.7 * i));
    series.add(0.1 * i, values.back());
  }
  // Two intervals of 100 values.
  const Json samples = series.samples();
  ASSERT_EQ(samples.size(), 4U);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(100 * k);
    const auto [least, greatest] = std::minmax_element(begin, begin + 100);
    const double a = samples[2 * k][1];
    const double b = samples[2 * k + 1][1];
    EXPECT_EQ(std::min(a, b), *least);
    EXPECT_EQ(std::max(a, b), *greatest);
    EXPECT_LT(samples[2 * k][0], samples[2 * k + 1][0]) << "in order of time";
  }
}

TEST(Series, AGapInTheValuesStaysAGap) {
  Series series(0.0, 1.0);
  for (const double time_s : {0.0, 1.0, 2.5, 3.0}) {
    series.add(time_s, 7.0);
  }
  series.add(3.5, std::numeric_limits<double>::infinity());
  series.add(4.5, 8.0);
  EXPECT_EQ(series.samples(), Json::parse("[[0,7],[1,7],[1,null],[2.5,7],[3,7],[3,null],[4.5,8]]"));
}

TEST(Series, WithoutValuesIsEmpty) {
  Series series(1.0, 1.0);
  EXPECT_EQ(series.samples(), Json::array());
  series.add(0.0, std::nan(""));
  EXPECT_EQ(series.samples(), Json::array());
}

TEST(LogHistory, ReadsAllLogsInOrderOfTime) {
  const test::TemporaryDir dir;
  const auto write = [&](const char* file, std::int64_t first_s) {
    bus::LogWriter log(dir.path() / file);
    std::vector<std::byte> bytes;
    nodmap::odometry_t odometry{};
    odometry.orientation[0] = 1.0;
    for (int i = 0; i < 10; ++i) {
      odometry.forward_mps = 0.1 * i;
      bus::encode_into(bytes, odometry);
      ASSERT_TRUE(log.write(1'000'000 * first_s + 100'000 * i, "ODOMETRY", bytes));
    }
    nodmap::status_t status{};
    status.process_name = "nodmap-slam2d";
    status.latency_p99_us = 1500.0;
    bus::encode_into(bytes, status);
    ASSERT_TRUE(log.write(1'000'000 * (first_s + 1), "STATUS", bytes));
    ASSERT_TRUE(log.write(1'000'000 * (first_s + 1), "ODOMETRY", std::vector<std::byte>(3)));
  };
  write("late", 110);
  write("early", 100);
  const Json history = log_history({dir.path() / "late", dir.path() / "early"});
  EXPECT_EQ(history.size(), 2U);
  const Json speeds = history["forward_mps"];
  ASSERT_EQ(speeds.size(), 21U);  // every value, and the gap between the logs
  EXPECT_EQ(speeds[0][0], 100.0);
  EXPECT_TRUE(speeds[10][1].is_null());
  EXPECT_EQ(speeds[11][0], 110.0);
  EXPECT_EQ(history["latency_p99_us nodmap-slam2d"],
            Json::parse("[[101,1500],[101,null],[111,1500]]"));
}

}  // namespace log_history_test
}  // namespace nodmap::viewer
