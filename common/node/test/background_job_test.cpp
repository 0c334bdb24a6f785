// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/background_job.hpp"

#include <gtest/gtest.h>

#include <future>
#include <stdexcept>

namespace nodmap::node {
namespace background_job_test {

TEST(BackgroundJob, GivesItsResultAtTheMessageThatWasFixed) {
  BackgroundJob<int> job;
  EXPECT_FALSE(job.count_message());
  job.start([] { return 7; }, 3);
  job.wait();
  EXPECT_FALSE(job.count_message());
  EXPECT_FALSE(job.count_message());
  EXPECT_EQ(job.count_message(), 7);
  EXPECT_FALSE(job.count_message());
}

TEST(BackgroundJob, ASlowJobIsWaitedForWhenItsResultIsDue) {
  std::promise<void> may_end;
  BackgroundJob<int> job;
  job.start(
      [end = may_end.get_future().share()] {
        end.wait();
        return 8;
      },
      2);
  EXPECT_FALSE(job.count_message());  // returns although the work has not ended
  may_end.set_value();
  EXPECT_EQ(job.count_message(), 8);
}

TEST(BackgroundJob, LiveNoMessageWaitsForASlowJob) {
  std::promise<void> may_end;
  BackgroundJob<int> job(ResultsUsed::kWhenReady);
  job.start(
      [end = may_end.get_future().share()] {
        end.wait();
        return 8;
      },
      1);
  EXPECT_FALSE(job.count_message());
  EXPECT_FALSE(job.count_message());
  EXPECT_FALSE(job.take_early());
  may_end.set_value();
  job.wait();
  EXPECT_EQ(job.count_message(), 8);
}

TEST(BackgroundJob, LiveAResultIsUsedAsSoonAsItIsReady) {
  BackgroundJob<int> job(ResultsUsed::kWhenReady);
  EXPECT_FALSE(job.count_message());
  job.start([] { return 7; }, 100);
  job.wait();
  EXPECT_EQ(job.count_message(), 7);
  job.start([] { return 9; }, 100);
  job.wait();
  EXPECT_EQ(job.take_early(), 9);
}

TEST(BackgroundJob, CanBeTakenEarlyAndStartedAgain) {
  BackgroundJob<int> job;
  EXPECT_FALSE(job.take());
  job.start([] { return 1; }, 100);
  EXPECT_EQ(job.take_early(), 1);
  EXPECT_FALSE(job.take_early());
  job.start([] { return 2; }, 1);
  EXPECT_EQ(job.count_message(), 2);
}

TEST(BackgroundJob, AnExceptionOfTheWorkComesWithTheResult) {
  BackgroundJob<int> job;
  job.start([]() -> int { throw std::runtime_error("no"); }, 1);
  job.wait();
  EXPECT_THROW(static_cast<void>(job.count_message()), std::runtime_error);
}

}  // namespace background_job_test
}  // namespace nodmap::node
