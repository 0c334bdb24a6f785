// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/save_requests.hpp"

#include <gtest/gtest.h>

#include "tests/support/memory_bus.hpp"

namespace nodmap::node {
namespace save_requests_test {

struct SaveRequestsTest : testing::Test {
  test::MemoryBus bus;
  node::MessageCounts counts;
  const Context context{bus, counts, "somewhere"};
  SaveRequests requests;
  const time::Timestamp start{24h};
};

TEST_F(SaveRequestsTest, OneInTenSecondsIsCarriedOut) {
  const nodmap::save_request_t request{};
  EXPECT_TRUE(requests.accept(request, context, start));
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(requests.accept(request, context, start + i * 9ms));
  }
  EXPECT_EQ(counts.rejected().at("save_request_too_soon"), 1000);
  EXPECT_TRUE(requests.accept(request, context, start + SaveRequests::kPeriod));
  EXPECT_TRUE(requests.accept(request, context, start - 1h)) << "the clock was set back";
}

TEST_F(SaveRequestsTest, AFailedSaveDoesNotCount) {
  EXPECT_TRUE(requests.accept({}, context, start));
  requests.forget();
  EXPECT_TRUE(requests.accept({}, context, start));
  EXPECT_FALSE(requests.accept({}, context, start));
}

TEST_F(SaveRequestsTest, WithoutAFolderNoneIsCarriedOut) {
  EXPECT_FALSE(requests.accept({}, Context{bus, counts, {}}, start));
  EXPECT_EQ(counts.rejected().at("save_request_without_out_dir"), 1);
}

}  // namespace save_requests_test
}  // namespace nodmap::node
