// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/staleness.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace staleness_test {

TEST(Staleness, EachInputHasItsLimit) {
  const StalenessParams limits;
  const time::Timestamp now(1s);
  const InputStamps fresh{now, now - 10ms, now - 10ms, now - 10ms, now - 10ms};
  EXPECT_FALSE(reason_by_staleness(fresh, limits, true));
  const auto with = [&](auto member, std::optional<time::Timestamp> stamp) {
    InputStamps stamps = fresh;
    stamps.*member = stamp;
    return reason_by_staleness(stamps, limits, true).has_value();
  };
  EXPECT_FALSE(with(&InputStamps::map, time::from_utime(900'000)));
  EXPECT_TRUE(with(&InputStamps::map, time::from_utime(899'999)));
  EXPECT_FALSE(with(&InputStamps::scan, time::from_utime(900'000)));
  EXPECT_TRUE(with(&InputStamps::scan, time::from_utime(899'999)));
  EXPECT_TRUE(with(&InputStamps::pitch_command, time::from_utime(849'999)));
  EXPECT_TRUE(with(&InputStamps::pitch_state, time::from_utime(849'999)));
  // Odometry behind the other inputs, or an input from the future.
  EXPECT_TRUE(with(&InputStamps::odometry, time::from_utime(880'000)));
  EXPECT_TRUE(with(&InputStamps::map, time::from_utime(1'100'001)));
  for (const auto member : {&InputStamps::odometry, &InputStamps::map, &InputStamps::scan,
                            &InputStamps::pitch_command, &InputStamps::pitch_state}) {
    EXPECT_TRUE(with(member, std::nullopt));
  }
}

TEST(Staleness, WithoutTheLocalMapNoScanIsNeeded) {
  const time::Timestamp now(1s);
  InputStamps stamps{now, now - 10ms, now - 10ms, now - 10ms, now - 10ms};
  stamps.scan.reset();
  EXPECT_FALSE(reason_by_staleness(stamps, {}, false));
  EXPECT_EQ(reason_by_staleness(stamps, {}, true), Reason(Why::kNoInput, "scan for the local map"));
}

}  // namespace staleness_test
}  // namespace nodmap::navigator
