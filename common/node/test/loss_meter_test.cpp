// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/loss_meter.hpp"

#include <gtest/gtest.h>

namespace nodmap::node {
namespace loss_meter_test {

// A device that sends 100 a second.
struct Stream {
  Stream() { meter.take(0, 0, now); }

  LossMeter meter;
  std::int64_t lost = 0;
  std::int64_t delivered = 0;
  time::SteadyTime now{5s};

  // One second in which `num_lost` are lost.
  void run(int num_lost) {
    for (int i = 0; i < 100; ++i) {
      now += 10ms;
      (i < num_lost ? lost : delivered) += 1;
      meter.take(lost, delivered, now);
    }
  }
};

TEST(LossMeter, CountsTheLastWholeSecond) {
  Stream stream;
  for (const int num_lost : {0, 10, 11, 100, 0}) {
    stream.run(num_lost);
    EXPECT_EQ(stream.meter.loses_many(), num_lost > 10) << num_lost;
  }
}

TEST(LossMeter, ADeviceThatSendsNothingLosesNothing) {
  Stream stream;
  stream.run(100);
  stream.run(100);
  ASSERT_TRUE(stream.meter.loses_many());
  stream.meter.take(stream.lost, stream.delivered, stream.now + 1s);
  EXPECT_FALSE(stream.meter.loses_many());
}

}  // namespace loss_meter_test
}  // namespace nodmap::node
