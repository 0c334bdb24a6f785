// SPDX-License-Identifier: BSD-3-Clause
#include "tools/watch/display.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace nodmap::watch {
namespace display_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

class DisplayTest : public testing::Test {
 protected:
  std::string line(time::Duration since_start) const {
    return status_line(overview_, at(since_start));
  }

  Overview overview_;
  std::ostringstream out_;
};

TEST_F(DisplayTest, AFileGetsALineEveryFiveSecondsOfDataAndTheLastState) {
  Display display(out_, false);
  display.show(overview_, at(9s));
  overview_.add(nodmap::scan_t{}, at(10s));
  display.show(overview_, at(10s));
  display.show(overview_, at(14s));
  EXPECT_EQ(out_.str(), "") << "no line before there is something to show";
  display.show(overview_, at(15s));
  display.show(overview_, at(19s));
  const std::string first = line(15s) + "\n";
  EXPECT_EQ(out_.str(), first);
  nodmap::odometry_t odometry{};
  odometry.forward_mps = 0.75;
  overview_.add(odometry, at(19s));
  display.end(overview_, at(19s));
  EXPECT_EQ(out_.str(), first + line(19s) + "\n");
}

TEST_F(DisplayTest, AFileGetsNothingWithoutData) {
  Display display(out_, false);
  display.show(overview_, at(0s));
  display.show(overview_, at(30s));
  display.end(overview_, at(30s));
  EXPECT_EQ(out_.str(), "");
}

TEST_F(DisplayTest, ATerminalShowsAtOnceThatNothingComes) {
  Display display(out_, true);
  display.show(overview_, at(0s));
  display.show(overview_, at(50ms));
  EXPECT_EQ(out_.str(), "\r\033[K" + line(0s));
  display.end(overview_, at(60ms));
  EXPECT_EQ(out_.str(), "\r\033[K" + line(0s) + "\r\033[K" + line(60ms) + "\n");
}

}  // namespace display_test
}  // namespace nodmap::watch
