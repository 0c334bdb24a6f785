// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/output_collector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::procman {
namespace {

using ::testing::ElementsAre;

TEST(OutputCollector, JoinsWhatComesWithinTenMilliseconds) {
  OutputCollector output;
  output.add("a", "1", 1'000'000);
  EXPECT_THAT(output.take(1'000'000), ElementsAre(Said{"a", "1"}));
  output.add("a", "2", 1'001'000);
  output.add("b", "x", 1'002'000);
  output.add("a", "3", 1'003'000);
  EXPECT_TRUE(output.take(1'009'999).empty());
  EXPECT_EQ(output.due_us(), 1'010'000);
  EXPECT_THAT(output.take(1'010'000), ElementsAre(Said{"a", "23"}, Said{"b", "x"}));
  EXPECT_FALSE(output.due_us().has_value());
}

TEST(OutputCollector, DoesNotWaitWithMoreThanFourKilobytes) {
  OutputCollector output;
  output.add("a", "1", 1'000'000);
  static_cast<void>(output.take(1'000'000));
  output.add("a", std::string(OutputCollector::kPromptBytes + 1, 'x'), 1'001'000);
  EXPECT_EQ(output.take(1'001'000).size(), 1U);
}

// 100 MB/s for ten seconds, in pieces as they are read.
TEST(OutputCollector, LimitsAFloodCountsItAndSaysSo) {
  OutputCollector output;
  const std::string piece(100'000, 'x');
  std::int64_t published = 0;
  std::int64_t largest = 0;
  int complaints = 0;
  constexpr std::int64_t kSteps = 10'000;
  for (std::int64_t step = 0; step < kSteps; ++step) {
    const std::int64_t now_us = 1'000'000 + step * 1'000;
    output.add("flood", piece, now_us);
    for (const Said& said : output.take(now_us)) {
      const auto size = static_cast<std::int64_t>(said.text.size());
      published += size;
      largest = std::max(largest, size);
      complaints += said.text.find("bytes of output dropped") != std::string::npos ? 1 : 0;
    }
  }
  const double limit =
      OutputCollector::kCommandBurstBytes + 10 * OutputCollector::kCommandBytesPerS;
  EXPECT_LE(static_cast<double>(published), limit + 11 * 80) << "and a line each second";
  EXPECT_GT(static_cast<double>(published), 0.9 * limit);
  EXPECT_EQ(complaints, 10);
  EXPECT_GT(output.dropped_bytes(), kSteps * 100'000 - published - 11 * 80);
}

TEST(OutputCollector, AFloodTakesNothingFromTheOthers) {
  OutputCollector output;
  int heard = 0;
  for (std::int64_t step = 0; step < 1'000; ++step) {
    const std::int64_t now_us = 1'000'000 + step * 10'000;
    output.add("flood", std::string(100'000, 'x'), now_us);
    output.add("quiet", "tick\n", now_us);
    for (const Said& said : output.take(now_us)) {
      heard += said.command_id == "quiet" ? 1 : 0;
    }
  }
  EXPECT_EQ(heard, 1'000);
}

TEST(OutputCollector, AllTogetherHaveALimitToo) {
  OutputCollector output;
  std::size_t published = 0;
  for (std::int64_t step = 0; step < 1'000; ++step) {
    const std::int64_t now_us = 1'000'000 + step * 10'000;
    for (int command = 0; command < 50; ++command) {
      output.add(std::to_string(command), std::string(5'000, 'x'), now_us);
    }
    for (const Said& said : output.take(now_us)) {
      published += said.text.size();
    }
  }
  // 10 s; and the lines of 50 commands, 80 bytes each second.
  EXPECT_LE(
      static_cast<double>(published),
      OutputCollector::kTotalBurstBytes + 10 * OutputCollector::kTotalBytesPerS + 50 * 11 * 80);
}

TEST(OutputCollector, ABurstGoesInMessagesOfOneDatagramEach) {
  OutputCollector output;
  std::string burst;
  for (int i = 0; i < 20'000; ++i) {
    burst += std::to_string(i % 10);
  }
  output.add("a", burst + burst + burst + burst, 1'000'000);
  output.add("b", "short", 1'000'000);
  std::string got;
  int messages = 0;
  std::int64_t now_us = 1'000'000;
  while (const auto due_us = output.due_us()) {
    now_us = std::max(now_us, *due_us);
    std::size_t size = 0;
    for (const Said& said : output.take(now_us)) {
      EXPECT_TRUE(said.command_id == "a" || messages == 0) << "the short text goes first";
      got += said.command_id == "a" ? said.text : "";
      size += said.text.size();
    }
    EXPECT_LE(size, OutputCollector::kMaxMessageBytes);
    ++messages;
  }
  EXPECT_EQ(messages, 3) << "80 kB in pieces of 32";
  EXPECT_EQ(now_us, 1'000'000 + 2 * OutputCollector::kPeriodUs);
  EXPECT_EQ(got, burst + burst + burst + burst) << "whole, in order";
}

TEST(OutputCollector, AForgottenCommandBeginsAnew) {
  OutputCollector output;
  const auto limit = static_cast<std::size_t>(OutputCollector::kCommandBurstBytes);
  output.add("a", std::string(limit + 1, 'x'), 1'000'000);
  EXPECT_EQ(output.dropped_bytes(), 1);
  output.forget("a");
  output.add("a", std::string(limit, 'x'), 1'000'000);
  EXPECT_EQ(output.dropped_bytes(), 1);
}

TEST(OutputCollector, DropsZeroBytesWhichWouldEndTheText) {
  OutputCollector output;
  output.add("a", std::string_view("a\0b", 3), 1'000'000);
  EXPECT_THAT(output.take(1'000'000), ElementsAre(Said{"a", "ab"}));
}

}  // namespace
}  // namespace nodmap::procman
