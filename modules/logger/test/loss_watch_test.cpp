// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/loss_watch.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "common/bus/codec.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::logger {
namespace loss_watch_test {

std::vector<std::byte> scan(std::int64_t seq) {
  nodmap::scan_t message{};
  message.scan_seq = seq;
  std::vector<std::byte> bytes;
  bus::encode_into(bytes, message);
  return bytes;
}

std::vector<std::byte> odometry(std::int64_t seq) {
  nodmap::odometry_t message{};
  message.odometry_seq = seq;
  std::vector<std::byte> bytes;
  bus::encode_into(bytes, message);
  return bytes;
}

TEST(LossWatch, CountsGapsForEachChannelByItself) {
  LossWatch losses;
  EXPECT_EQ(losses.lost_before("SCAN", scan(10)), 0);
  EXPECT_EQ(losses.lost_before("ODOMETRY", odometry(500)), 0);
  EXPECT_EQ(losses.lost_before("SCAN", scan(11)), 0);
  EXPECT_EQ(losses.lost_before("SCAN", scan(15)), 3);
  EXPECT_EQ(losses.lost_before("ODOMETRY", odometry(502)), 1);
}

TEST(LossWatch, ARestartedPublisherHasLostNothing) {
  LossWatch losses;
  EXPECT_EQ(losses.lost_before("SCAN", scan(1000)), 0);
  EXPECT_EQ(losses.lost_before("SCAN", scan(0)), 0);
  EXPECT_EQ(losses.lost_before("SCAN", scan(1)), 0);
}

TEST(LossWatch, OtherAndDamagedMessagesAreIgnored) {
  LossWatch losses;
  std::vector<std::byte> damaged = scan(7);
  damaged.resize(damaged.size() - 1);
  EXPECT_EQ(losses.lost_before("SCAN", scan(1)), 0);
  EXPECT_EQ(losses.lost_before("SCAN", damaged), 0);
  EXPECT_EQ(losses.lost_before("SCAN", {}), 0);
  EXPECT_EQ(losses.lost_before("SCAN", scan(2)), 0);
}

}  // namespace loss_watch_test
}  // namespace nodmap::logger
