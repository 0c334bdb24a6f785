// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/output_collector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>

namespace nodmap::procman {
namespace output_collector_test {

using ::testing::ElementsAre;

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

// All remaining output of all commands.
std::string everything_of(OutputCollector& output) {
  std::string text;
  while (const auto due = output.due()) {
    for (const CommandOutput& part : output.take(*due)) {
      text += part.text;
    }
  }
  return text;
}

TEST(OutputCollector, JoinsOutputThatComesWithinTenMilliseconds) {
  OutputCollector output;
  output.add("a", "1", at(1s));
  EXPECT_THAT(output.take(at(1s)), ElementsAre(CommandOutput{"a", "1"}));
  output.add("a", "2", at(1001ms));
  output.add("b", "x", at(1002ms));
  output.add("a", "3", at(1003ms));
  EXPECT_TRUE(output.take(at(1'009'999us)).empty());
  EXPECT_EQ(output.due(), at(1010ms));
  EXPECT_THAT(output.take(at(1010ms)),
              ElementsAre(CommandOutput{"a", "23"}, CommandOutput{"b", "x"}));
  EXPECT_FALSE(output.due().has_value());
}

TEST(OutputCollector, PublishesMoreThanFourKilobytesWithoutWaiting) {
  OutputCollector output;
  output.add("a", "1", at(1s));
  static_cast<void>(output.take(at(1s)));
  output.add("a", std::string(OutputCollector::kPromptBytes + 1, 'x'), at(1001ms));
  EXPECT_EQ(output.take(at(1001ms)).size(), 1U);
}

// 100 MB/s for ten seconds, in the pieces in which it is read.
TEST(OutputCollector, LimitsAFloodCountsTheDroppedBytesAndReportsThem) {
  OutputCollector output;
  const std::string piece(100'000, 'x');
  std::int64_t published = 0;
  std::int64_t largest = 0;
  int reports = 0;
  constexpr std::int64_t kSteps = 10'000;
  for (std::int64_t step = 0; step < kSteps; ++step) {
    const time::SteadyTime now = at(1s + step * 1ms);
    output.add("flood", piece, now);
    for (const CommandOutput& part : output.take(now)) {
      const auto size = static_cast<std::int64_t>(part.text.size());
      published += size;
      largest = std::max(largest, size);
      reports += part.text.find("bytes of output dropped") != std::string::npos ? 1 : 0;
    }
  }
  const double limit =
      OutputCollector::kCommandBurstBytes + 10 * OutputCollector::kCommandBytesPerS;
  EXPECT_LE(static_cast<double>(published), limit + 11 * 80) << "and one line each second";
  EXPECT_GT(static_cast<double>(published), 0.9 * limit);
  EXPECT_EQ(reports, 9) << "one each second";
  EXPECT_GT(output.dropped_bytes(), kSteps * 100'000 - published - 11 * 80 -
                                        static_cast<std::int64_t>(OutputCollector::kTailBytes));
}

TEST(OutputCollector, AFloodDoesNotReduceTheOutputOfOtherCommands) {
  OutputCollector output;
  int received = 0;
  for (std::int64_t step = 0; step < 1'000; ++step) {
    const time::SteadyTime now = at(1s + step * 10ms);
    output.add("flood", std::string(100'000, 'x'), now);
    output.add("quiet", "tick\n", now);
    for (const CommandOutput& part : output.take(now)) {
      received += part.command_id == "quiet" ? 1 : 0;
    }
  }
  EXPECT_EQ(received, 1'000);
}

TEST(OutputCollector, AllCommandsTogetherHaveALimitAsWell) {
  OutputCollector output;
  std::size_t published = 0;
  for (std::int64_t step = 0; step < 1'000; ++step) {
    const time::SteadyTime now = at(1s + step * 10ms);
    for (int command = 0; command < 50; ++command) {
      output.add(std::to_string(command), std::string(5'000, 'x'), now);
    }
    for (const CommandOutput& part : output.take(now)) {
      published += part.text.size();
    }
  }
  // The limit for 10 s, and for each of 50 commands a line of 80 bytes per second.
  EXPECT_LE(
      static_cast<double>(published),
      OutputCollector::kTotalBurstBytes + 10 * OutputCollector::kTotalBytesPerS + 50 * 11 * 80);
}

TEST(OutputCollector, ABurstIsSplitIntoMessagesOfOneDatagramEach) {
  OutputCollector output;
  std::string burst;
  for (int i = 0; i < 20'000; ++i) {
    burst += std::to_string(i % 10);
  }
  output.add("a", burst + burst + burst + burst, at(1s));
  output.add("b", "short", at(1s));
  std::string got;
  int messages = 0;
  time::SteadyTime now = at(1s);
  while (const auto due = output.due()) {
    now = std::max(now, *due);
    std::size_t size = 0;
    for (const CommandOutput& part : output.take(now)) {
      EXPECT_TRUE(part.command_id == "a" || messages == 0) << "the short text goes first";
      got += part.command_id == "a" ? part.text : "";
      size += part.text.size();
    }
    EXPECT_LE(size, OutputCollector::kMaxMessageBytes);
    ++messages;
  }
  EXPECT_EQ(messages, 3) << "80 kB in pieces of 32";
  EXPECT_EQ(now, at(1s) + 2 * OutputCollector::kPeriod);
  EXPECT_EQ(got, burst + burst + burst + burst) << "complete and in order";
}

TEST(OutputCollector, AForgottenCommandStartsWithItsFirstBurstOnly) {
  OutputCollector output;
  const auto limit = static_cast<std::size_t>(OutputCollector::kCommandBurstBytes);
  output.add("a", std::string(limit, 'x') + "last\n", at(1s));
  output.forget("a");
  const std::string all = everything_of(output);
  EXPECT_TRUE(all.ends_with("last\n")) << "output that was still held back is not lost";
  // The old limit has not recovered yet, so only the burst of a new command is published.
  output.add("a", std::string(limit, 'y'), at(2'000'001us));
  EXPECT_EQ(everything_of(output), std::string(limit, 'y'));
}

// Lines of 20 bytes, 6 MB/s for two seconds, cut into pieces anywhere.
TEST(OutputCollector, LinesArriveWholeOrNotAtAllAndTheLastOneAlwaysArrives) {
  OutputCollector output;
  constexpr int kLines = 600'000;
  std::string written;
  for (int i = 0; i < kLines; ++i) {
    std::string number = std::to_string(i);
    written += std::string(13 - number.size(), '0') + number + " line\n";
  }
  std::string got;
  for (std::size_t begin = 0; begin < written.size(); begin += 6'007) {
    const time::SteadyTime now = at(1s + 1us * (begin / 6));
    output.add("a", written.substr(begin, 6'007), now);
    for (const CommandOutput& part : output.take(now)) {
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

TEST(OutputCollector, DropsZeroBytesBecauseTheyWouldEndTheText) {
  OutputCollector output;
  output.add("a", std::string_view("a\0b", 3), at(1s));
  EXPECT_THAT(output.take(at(1s)), ElementsAre(CommandOutput{"a", "ab"}));
}

TEST(OutputCollector, RepeatsTheNewestLinesOfAllCommandsOnce) {
  OutputCollector output;
  std::string all;
  for (int i = 0; i < 1000; ++i) {
    all += "line " + std::to_string(i) + "\n";
  }
  output.add("a", all, at(1s));
  output.add("b", "short\n", at(1s));
  static_cast<void>(everything_of(output));
  EXPECT_FALSE(output.repeat_due().has_value());
  for (int second = 2; second < 4; ++second) {
    output.repeat();
    output.repeat();  // two sheriffs have begun
    EXPECT_TRUE(output.repeat_due().has_value());
    const auto repeated = output.take_repeated(at(second * 1s));
    ASSERT_EQ(repeated.size(), 2U);
    EXPECT_TRUE(repeated[0].text.starts_with("line "));
    EXPECT_TRUE(repeated[0].text.ends_with("line 998\nline 999\n"));
    EXPECT_LE(repeated[0].text.size(), OutputCollector::kTailBytes);
    EXPECT_EQ(repeated[0].text, output.recent_of_run("a"));
    EXPECT_EQ(repeated[1], (CommandOutput{"b", "short\n"}));
    EXPECT_FALSE(output.repeat_due().has_value());
    EXPECT_EQ(everything_of(output), "") << "it is no new output";
  }
  output.repeat();
  output.forget("a");
  EXPECT_EQ(output.recent_of_run("a"), "");
  EXPECT_THAT(output.take_repeated(at(5s)), ElementsAre(CommandOutput{"b", "short\n"}));
  EXPECT_FALSE(output.repeat_due().has_value());
}

// A sheriff prints it, and then what comes: nothing twice, and nothing is missing.
TEST(OutputCollector, RepeatsWhatIsPublishedAndNoMore) {
  OutputCollector output;
  output.add("a", "1", at(1s));
  static_cast<void>(output.take(at(1s)));
  output.add("a", "2", at(1001ms));
  output.repeat();
  EXPECT_TRUE(output.take_repeated(at(1001ms)).empty()) << "2 is not published yet";
  EXPECT_FALSE(output.repeat_due().has_value()) << "it waits for take()";
  EXPECT_THAT(output.take(at(1010ms)), ElementsAre(CommandOutput{"a", "2"}));
  EXPECT_THAT(output.take_repeated(at(1010ms)), ElementsAre(CommandOutput{"a", "12"}));
  // The same for output that is held back.
  output.add("a", std::string(2 * std::size_t{OutputCollector::kTailBytes}, 'x') + "\n", at(2s));
  const auto burst = static_cast<std::size_t>(OutputCollector::kCommandBurstBytes);
  output.add("a", std::string(burst, 'y') + "\nlast\n", at(2s));
  output.repeat();
  time::SteadyTime now = at(2s);
  std::string published;
  while (const auto due = output.due()) {
    EXPECT_TRUE(output.take_repeated(now).empty());
    now = std::max(now, *due);
    for (const CommandOutput& part : output.take(now)) {
      published += part.text;
    }
  }
  const auto repeated = output.take_repeated(now);
  ASSERT_EQ(repeated.size(), 1U);
  EXPECT_TRUE(published.ends_with("last\n"));
  EXPECT_TRUE(repeated[0].text.ends_with("last\n"));
}

// Anybody can say all the time that a sheriff has begun.
TEST(OutputCollector, TheRateOfRepetitionsIsLimitedAndEachCommandHasItsTurn) {
  OutputCollector output;
  constexpr int kCommands = 100;
  for (int command = 0; command < kCommands; ++command) {
    output.add(std::to_string(command), std::string(OutputCollector::kTailBytes, 'x'), at(1s));
  }
  static_cast<void>(everything_of(output));
  std::map<std::string, int> counts;
  std::size_t published = 0;
  for (std::int64_t step = 0; step < 1'000; ++step) {
    output.repeat();
    std::size_t size = 0;
    for (const CommandOutput& part : output.take_repeated(at(10s + step * 10ms))) {
      size += part.text.size();
      ++counts[part.command_id];
    }
    EXPECT_LE(size, OutputCollector::kMaxMessageBytes);
    published += size;
  }
  EXPECT_EQ(published, 100 * OutputCollector::kMaxMessageBytes) << "ten messages a second";
  ASSERT_EQ(counts.size(), std::size_t{kCommands});
  for (const auto& [id, count] : counts) {
    EXPECT_NEAR(count, 8, 1) << id << ": commands of one message may change places";
  }
}

TEST(OutputCollector, TheOutputOfARunIsWithoutThatOfEarlierOnes) {
  OutputCollector output;
  output.begin_run("a");
  output.add("a", "first run\nof two", at(1s));
  output.begin_run("a");
  EXPECT_EQ(output.recent_of_run("a"), "");
  output.add("a", "second", at(2s));
  output.add("a", " run\n", at(2s));
  EXPECT_EQ(output.recent_of_run("a"), "second run\n");
  output.add("a", std::string(2 * OutputCollector::kTailBytes, 'x'), at(3s));
  EXPECT_EQ(output.recent_of_run("a"), std::string(OutputCollector::kTailBytes, 'x'));
  output.begin_run("a");
  output.add("a", "third\n", at(4s));
  EXPECT_EQ(output.recent_of_run("a"), "third\n");
}

}  // namespace output_collector_test
}  // namespace nodmap::procman
