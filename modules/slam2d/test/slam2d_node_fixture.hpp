// SPDX-License-Identifier: BSD-3-Clause
// For tests: 2D SLAM's process in a drawn room, on a bus in memory.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "common/node/messages.hpp"
#include "modules/slam2d/node.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::slam2d::test {

class Slam2dNodeTest : public testing::Test {
 protected:
  void put_scan(time::Duration since_epoch, const geometry::SE2& truth) {
    scan::Scan scan = scanner_.scan(room(), truth, time::Timestamp(since_epoch));
    scan.seq = seq_++;
    bus_.deliver("SCAN", node::write_scan(scan));
  }
  void put_odometry(time::Duration since_epoch, const geometry::SE2& pose) {
    auto message = node::write_odometry(time::Timestamp(since_epoch), geometry::to_se3(pose));
    message.odometry_seq = odometry_seq_++;
    bus_.deliver("ODOMETRY", message);
  }

  nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  Slam2dNode node_{context_, Slam2dParams{}};
  Scanner scanner_;
  std::int64_t seq_ = 0;
  std::int64_t odometry_seq_ = 0;
};

}  // namespace nodmap::slam2d::test
