// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_saving.hpp"

#include <gtest/gtest.h>

#include "tests/support/memory_bus.hpp"

namespace nodmap::node {
namespace map_saving_test {

struct MapSavingTest : testing::Test {
  test::MemoryBus bus;
  node::MessageCounts counts;
  Context context{bus, counts, "somewhere"};
  MapSaving saving{context};
  const time::Timestamp start{24h};
  const std::error_code full = std::make_error_code(std::errc::no_space_on_device);
};

TEST_F(MapSavingTest, OneRequestInTenSecondsIsCarriedOut) {
  EXPECT_TRUE(saving.accept({}, start));
  saving.record({}, start);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(saving.accept({}, start + i * 9ms));
  }
  EXPECT_EQ(counts.rejected().at("save_request_too_soon"), 1000);
  EXPECT_TRUE(saving.accept({}, start + MapSaving::kRequestPeriod));
  EXPECT_TRUE(saving.accept({}, start - 1h)) << "the clock was set back";
}

TEST_F(MapSavingTest, AfterAFailureARequestIsCarriedOutAtOnce) {
  EXPECT_TRUE(saving.accept({}, start));
  saving.record(full, start);
  EXPECT_TRUE(saving.accept({}, start));
  EXPECT_FALSE(saving.accept({}, start));
}

TEST_F(MapSavingTest, WithoutAFolderNoRequestIsCarriedOut) {
  context.out_dir.clear();
  EXPECT_FALSE(saving.accept({}, start));
  EXPECT_EQ(counts.rejected().at("save_request_without_out_dir"), 1);
}

TEST_F(MapSavingTest, AFailureIsReportedAndTheSaveRepeatedUntilItSucceeds) {
  EXPECT_FALSE(saving.is_due(start));
  EXPECT_FALSE(saving.problem());
  saving.record(full, start);
  ASSERT_TRUE(saving.problem());
  EXPECT_EQ(saving.problem()->state, HealthState::kDegraded);
  EXPECT_FALSE(saving.is_due(start + MapSaving::kRetryPeriod - 1us));
  time::Timestamp retry = start + MapSaving::kRetryPeriod;
  EXPECT_TRUE(saving.is_due(retry));
  saving.record(full, retry);
  EXPECT_FALSE(saving.is_due(retry));
  retry += MapSaving::kRetryPeriod;
  EXPECT_TRUE(saving.is_due(retry));
  saving.record({}, retry);
  EXPECT_FALSE(saving.problem());
  EXPECT_FALSE(saving.is_due(retry + 1h));
}

}  // namespace map_saving_test
}  // namespace nodmap::node
