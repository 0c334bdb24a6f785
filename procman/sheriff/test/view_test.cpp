// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "procman/sheriff/printable.hpp"

namespace nodmap::procman {
namespace view_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;

ReportRow running(const std::string& id, const std::string& group) {
  ReportRow row;
  row.id = id;
  row.group = group;
  row.deputy = "robot";
  row.state = CommandState::kRunning;
  row.pid = 4242;
  row.cpu_percent = 12.5;
  row.memory_mb = 30.25;
  row.uptime = 3725s;
  row.restarts = 2;
  row.health = ProcessHealth{.state = ProcessHealth::State::kDegraded,
                             .reason = "no scans",
                             .handled_per_s = 75.0,
                             .latency_p50_us = 100.0};
  row.last_output = "said last";
  return row;
}

std::vector<ReportRow> robot() {
  return {running("kurt", "10.drivers"), running("laser3d", "10.drivers"),
          running("pitch-controller", "10.drivers"), running("navigator", "40.navigation")};
}

// The number of lines that contain a text.
std::ptrdiff_t count(const std::vector<ViewLine>& view, const std::string& text) {
  return std::ranges::count_if(
      view, [&text](const ViewLine& line) { return line.text.find(text) != std::string::npos; });
}

TEST(View, ShowsAllColumnsOfARunningCommandIn80Characters) {
  const auto view = to_view(robot(), nullptr, {1, "title", "message"}, 80, 24);
  ASSERT_EQ(view.size(), 24U);
  EXPECT_EQ(view[0].text, "title");
  EXPECT_EQ(view[2].text, "10.drivers");
  const ViewLine& selected = view[4];
  EXPECT_EQ(selected.tone, Tone::kSelected);
  EXPECT_THAT(selected.text, StartsWith("> laser3d"));
  for (const char* part : {"robot", "Running", "DEGRADED", "4242", "12.5", "30.2", "1h2m", "2"}) {
    EXPECT_THAT(selected.text, HasSubstr(part));
  }
  EXPECT_EQ(count(view, "10.drivers"), 1) << "a group's name is shown once";
  EXPECT_EQ(count(view, "--- laser3d: Running; DEGRADED: no scans (75/s, p50 100 us,"), 1);
  EXPECT_EQ(view[21].text, "message");
  EXPECT_THAT(view[23].text, HasSubstr("q quit"));
}

TEST(View, ShowsTheEndOfTheSelectedCommandsOutput) {
  Console console;
  for (int i = 0; i < 100; ++i) {
    console.take("line " + std::to_string(i) + "\r\n");
  }
  const auto view = to_view(robot(), &console, {0, "", ""}, 80, 24);
  EXPECT_THAT(view[20].text, "line 99") << "the newest line is above the message";
  EXPECT_EQ(count(view, "line "), 24 - 4 - 7 - 1) << "all the room that the table leaves";
}

TEST(View, ScrollsThroughTheOutput) {
  Console console;
  for (int i = 0; i < 100; ++i) {
    console.take("line " + std::to_string(i) + "\r\n");
  }
  const auto last_shown = [&](std::size_t lines_back) {
    return to_view(robot(), &console, {0, "", "", lines_back}, 80, 24)[20].text;
  };
  EXPECT_EQ(last_shown(0), "line 99");
  EXPECT_EQ(last_shown(30), "line 69");
  EXPECT_EQ(last_shown(1000), "line 11") << "scrolled to the first twelve lines";
  EXPECT_EQ(count(to_view(robot(), &console, {0, "", "", 30}, 80, 24), "30 lines below"), 1);
  EXPECT_EQ(count(to_view(robot(), nullptr, {0, "", "", 30}, 80, 24), "lines below"), 0);
}

TEST(View, NamesTheScriptsByTheirKeys) {
  ViewState state;
  state.scripts = {"start_robot", "stop\x1B_all"};
  const auto view = to_view(robot(), nullptr, state, 80, 24);
  EXPECT_EQ(view[22].text, "scripts:  1 start_robot  2 stop?_all");
}

TEST(View, FitsAnySizeAndFollowsTheSelection) {
  Console console;
  console.take("output\n");
  const auto rows = robot();
  for (std::size_t height = 0; height < 30; ++height) {
    for (const std::size_t width : {0U, 1U, 20U, 80U, 200U}) {
      for (std::size_t selected = 0; selected < rows.size(); ++selected) {
        const auto view = to_view(rows, &console, {selected, "title", "message"}, width, height);
        EXPECT_LE(view.size(), height);
        for (const ViewLine& line : view) {
          EXPECT_LE(line.text.size(), width);
        }
        if (height >= 7) {
          const auto marked = std::ranges::find_if(
              view, [](const ViewLine& line) { return line.tone == Tone::kSelected; });
          ASSERT_NE(marked, view.end()) << height << " lines, " << selected;
          const std::string name = "> " + rows[selected].id;
          EXPECT_THAT(marked->text, StartsWith(name.substr(0, marked->text.size())));
        }
      }
    }
  }
}

TEST(View, TruncatesLinesBetweenCharactersOnly) {
  auto rows = robot();
  rows[0].last_output = "\xC3\xA4\xC3\xB6\xC3\xBC";
  for (std::size_t width = 1; width < 140; ++width) {
    for (const ViewLine& line : to_view(rows, nullptr, {3, "", ""}, width, 24)) {
      EXPECT_EQ(printable(line.text), line.text) << width;
    }
  }
}

TEST(View, FailedAndStoppedCommandsAreHighlighted) {
  auto rows = robot();
  rows[0].health = ProcessHealth{};
  rows[1].health = ProcessHealth{.state = ProcessHealth::State::kFailed, .reason = "no device"};
  rows[2].pid = 0;
  rows[2].health.reset();
  rows[2].state = CommandState::kStoppedError;
  rows[2].end = "exit 3";
  const auto view = to_view(rows, nullptr, {3, "", ""}, 80, 24);
  const auto tone = [&view](const std::string& id) {
    return std::ranges::find_if(
               view, [&id](const ViewLine& line) { return line.text.starts_with("  " + id); })
        ->tone;
  };
  EXPECT_EQ(tone("kurt"), Tone::kPlain);
  EXPECT_EQ(tone("laser3d"), Tone::kAlarm);
  EXPECT_EQ(tone("pitch-controller"), Tone::kAlarm);
  const auto ended = to_view(rows, nullptr, {2, "", ""}, 80, 24);
  EXPECT_EQ(count(ended, "--- pitch-controller: Stopped (Error), exit 3"), 1);
}

TEST(View, ControlCharactersInNamesAreNotShown) {
  auto rows = robot();
  rows[0].id = "a\x1B[2J";
  rows[0].group = "\x1B]0;x\x07";
  for (const ViewLine& line : to_view(rows, nullptr, {0, "", ""}, 80, 24)) {
    EXPECT_EQ(line.text.find('\x1B'), std::string::npos);
  }
}

TEST(View, WithoutCommandsTheFrameIsShown) {
  EXPECT_EQ(to_view({}, nullptr, {0, "title", "message"}, 80, 24).size(), 5U)
      << "title, columns, message, scripts, keys";
}

}  // namespace view_test
}  // namespace nodmap::procman
