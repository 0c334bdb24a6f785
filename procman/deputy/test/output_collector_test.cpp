// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/output_collector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace nodmap::procman {
namespace {

using ::testing::ElementsAre;

/// All that is still to be published, of all commands.
std::string everything_of(OutputCollector& output) {
  std::string text;
  while (const auto due_us = output.due_us()) {
    for (const CommandOutput& part : output.take(*due_us)) {
      text += part.text;
    }
  }
  return text;
}

TEST(OutputCollector, JoinsWhatComesWithinTenMilliseconds) {
  OutputCollector output;
  output.add("a", "1", 1'000'000);
  EXPECT_THAT(output.take(1'000'000), ElementsAre(CommandOutput{"a", "1"}));
  output.add("a", "2", 1'001'000);
  output.add("b", "x", 1'002'000);
  output.add("a", "3", 1'003'000);
  EXPECT_TRUE(output.take(1'009'999).empty());
  EXPECT_EQ(output.due_us(), 1'010'000);
  EXPECT_THAT(output.take(1'010'000),
              ElementsAre(CommandOutput{"a", "23"}, CommandOutput{"b", "x"}));
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
  int reports = 0;
  constexpr std::int64_t kSteps = 10'000;
  for (std::int64_t step = 0; step < kSteps; ++step) {
    const std::int64_t now_us = 1'000'000 + step * 1'000;
    output.add("flood", piece, now_us);
    for (const CommandOutput& part : output.take(now_us)) {
      const auto size = static_cast<std::int64_t>(part.text.size());
      published += size;
      largest = std::max(largest, size);
      reports += part.text.find("bytes of output dropped") != std::string::npos ? 1 : 0;
    }
  }
  const double limit =
      OutputCollector::kCommandBurstBytes + 10 * OutputCollector::kCommandBytesPerS;
  EXPECT_LE(static_cast<double>(published), limit + 11 * 80) << "and a line each second";
  EXPECT_GT(static_cast<double>(published), 0.9 * limit);
  EXPECT_EQ(reports, 9) << "each time after a second";
  EXPECT_GT(output.dropped_bytes(), kSteps * 100'000 - published - 11 * 80 -
                                        static_cast<std::int64_t>(OutputCollector::kTailBytes));
}

TEST(OutputCollector, AFloodTakesNothingFromTheOthers) {
  OutputCollector output;
  int heard = 0;
  for (std::int64_t step = 0; step < 1'000; ++step) {
    const std::int64_t now_us = 1'000'000 + step * 10'000;
    output.add("flood", std::string(100'000, 'x'), now_us);
    output.add("quiet", "tick\n", now_us);
    for (const CommandOutput& part : output.take(now_us)) {
      heard += part.command_id == "quiet" ? 1 : 0;
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
    for (const CommandOutput& part : output.take(now_us)) {
      published += part.text.size();
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
    for (const CommandOutput& part : output.take(now_us)) {
      EXPECT_TRUE(part.command_id == "a" || messages == 0) << "the short text goes first";
      got += part.command_id == "a" ? part.text : "";
      size += part.text.size();
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
  output.add("a", std::string(limit, 'x') + "last\n", 1'000'000);
  output.forget("a");
  const std::string all = everything_of(output);
  EXPECT_TRUE(all.ends_with("last\n")) << "what was held back is not lost";
  // Its limit has not filled up again by now: what passes is a new command's burst.
  output.add("a", std::string(limit, 'y'), 2'000'001);
  EXPECT_EQ(everything_of(output), std::string(limit, 'y'));
}

// Lines of 20 bytes, 6 MB/s for two seconds, in pieces that end anywhere.
TEST(OutputCollector, EveryLineArrivesWholeAndTheLastOneAlways) {
  OutputCollector output;
  constexpr int kLines = 600'000;
  std::string written;
  for (int i = 0; i < kLines; ++i) {
    std::string number = std::to_string(i);
    written += std::string(13 - number.size(), '0') + number + " line\n";
  }
  std::string got;
  for (std::size_t at = 0; at < written.size(); at += 6'007) {
    const auto now_us = static_cast<std::int64_t>(1'000'000 + at / 6);
    output.add("a", written.substr(at, 6'007), now_us);
    for (const CommandOutput& part : output.take(now_us)) {
      got += part.text;
    }
  }
  got += everything_of(output);
  std::istringstream lines(got);
  std::string line;
  std::int64_t bytes = 0;
  std::int64_t dropped = 0;
  int newest = -1;
  while (std::getline(lines, line)) {
    if (line.starts_with("[nodmap-deputy: ")) {
      dropped += std::stoll(line.substr(16));
      continue;
    }
    ASSERT_EQ(line.size(), 18U) << line;
    ASSERT_TRUE(line.ends_with(" line")) << line;
    ASSERT_GT(std::stoi(line), newest) << "in order";
    newest = std::stoi(line);
    bytes += 19;
  }
  EXPECT_EQ(newest, kLines - 1);
  EXPECT_EQ(bytes + dropped, static_cast<std::int64_t>(written.size())) << "counted to the byte";
  EXPECT_GT(dropped, 0);
}

TEST(OutputCollector, DropsZeroBytesWhichWouldEndTheText) {
  OutputCollector output;
  output.add("a", std::string_view("a\0b", 3), 1'000'000);
  EXPECT_THAT(output.take(1'000'000), ElementsAre(CommandOutput{"a", "ab"}));
}

TEST(OutputCollector, RepeatsTheNewestLinesOnce) {
  OutputCollector output;
  std::string all;
  for (int i = 0; i < 1000; ++i) {
    all += "line " + std::to_string(i) + "\n";
  }
  output.add("a", all, 1'000'000);
  EXPECT_EQ(everything_of(output), all);
  for (int i = 0; i < 2; ++i) {  // what is repeated does not count as written
    output.repeat("a", 2'000'000);
    const std::string repeated = everything_of(output);
    EXPECT_TRUE(repeated.starts_with("line "));
    EXPECT_TRUE(repeated.ends_with("line 998\nline 999\n"));
    EXPECT_LE(repeated.size(), OutputCollector::kTailBytes);
    EXPECT_EQ(repeated, output.recent("a"));
  }
  output.repeat("nobody", 2'000'000);
  EXPECT_EQ(everything_of(output), "");
  output.forget("a");
  EXPECT_EQ(output.recent("a"), "");
}

}  // namespace
}  // namespace nodmap::procman
