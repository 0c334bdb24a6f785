// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/live_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::procman {
namespace live_view_test {

using ::testing::ElementsAre;

ReportRow row(const std::string& id, const std::string& group) {
  ReportRow made;
  made.id = id;
  made.group = group;
  return made;
}

class LiveViewTest : public ::testing::Test {
 protected:
  LiveViewTest() { dut_.update({row("sim", ""), row("kurt", "drivers"), row("slam", "slam")}); }

  OrderRequest order(Key key) {
    const std::optional<KeyRequest> request = dut_.press(key, nullptr);
    EXPECT_TRUE(request && std::holds_alternative<OrderRequest>(*request));
    return request ? std::get<OrderRequest>(*request) : OrderRequest{};
  }

  LiveView dut_;
};

TEST_F(LiveViewTest, ArrowsSelectAndStopAtTheEnds) {
  EXPECT_FALSE(dut_.press(Key::kUp, nullptr));
  EXPECT_EQ(dut_.selected()->id, "sim");
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(dut_.press(Key::kDown, nullptr));
  }
  EXPECT_EQ(dut_.selected()->id, "slam");
  EXPECT_FALSE(dut_.press(Key::kUp, nullptr));
  EXPECT_EQ(dut_.selected()->id, "kurt");
}

TEST_F(LiveViewTest, TheSelectionStaysInsideWhenCommandsVanish) {
  dut_.press(Key::kDown, nullptr);
  dut_.press(Key::kDown, nullptr);
  dut_.update({row("sim", "")});
  EXPECT_EQ(dut_.selected()->id, "sim");
  dut_.update({});
  EXPECT_EQ(dut_.selected(), nullptr);
  EXPECT_FALSE(dut_.press(Key::kStart, nullptr)) << "there is nothing to start";
  EXPECT_FALSE(dut_.press(Key::kDown, nullptr));
}

// A key is for what the screen showed when it was pressed.
TEST_F(LiveViewTest, TheSelectionStaysAtItsCommandWhenOthersAppearOrVanish) {
  dut_.press(Key::kDown, nullptr);
  dut_.update({row("camera", ""), row("sim", ""), row("kurt", "drivers"), row("slam", "slam")});
  EXPECT_THAT(order(Key::kStop).commands, ElementsAre("kurt"));
  dut_.update({row("kurt", "drivers"), row("slam", "slam")});
  EXPECT_THAT(order(Key::kStop).commands, ElementsAre("kurt"));
  // A command that was moved has a row on each host for a while.
  ReportRow elsewhere = row("kurt", "drivers");
  elsewhere.deputy = "a";
  dut_.update({elsewhere, row("kurt", "drivers"), row("slam", "slam")});
  EXPECT_EQ(dut_.selected()->deputy, "");
}

TEST_F(LiveViewTest, KeysOrderForTheCommandOrItsGroup) {
  dut_.update({row("kurt", "drivers"), row("laser", "drivers/laser"), row("slam", "slam")});
  EXPECT_EQ(order(Key::kStop).verb, Verb::kStop);
  EXPECT_THAT(order(Key::kRestart).commands, ElementsAre("kurt"));
  const OrderRequest group = order(Key::kStartGroup);
  EXPECT_EQ(group.verb, Verb::kStart);
  EXPECT_EQ(group.target, "drivers");
  EXPECT_THAT(group.commands, ElementsAre("kurt", "laser")) << "with the groups inside it";
}

TEST_F(LiveViewTest, WithoutAGroupTheKeysOfGroupsMeanTheCommand) {
  const OrderRequest request = order(Key::kStopGroup);
  EXPECT_EQ(request.target, "sim");
  EXPECT_THAT(request.commands, ElementsAre("sim"));
}

TEST_F(LiveViewTest, DigitsAskForScriptsAndQForTheEnd) {
  const auto script = dut_.press(Key::kLastScript, nullptr);
  ASSERT_TRUE(script && std::holds_alternative<ScriptRequest>(*script));
  EXPECT_EQ(std::get<ScriptRequest>(*script).index, 8U);
  const auto quit = dut_.press(Key::kQuit, nullptr);
  EXPECT_TRUE(quit && std::holds_alternative<QuitRequest>(*quit));
}

// With 8 lines of output: 5 a key, never beyond the first line or the last.
TEST_F(LiveViewTest, PageKeysScrollTheOutput) {
  Console console;
  for (int i = 0; i < 8; ++i) {
    console.take("line " + std::to_string(i) + "\n");
  }
  const auto has_line = [&](const std::string& text) {
    for (const ViewLine& line : dut_.lines("title", &console, {}, {80, 14})) {
      if (line.text.find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  };
  EXPECT_TRUE(has_line("line 7"));
  dut_.press(Key::kPageUp, &console);
  EXPECT_TRUE(has_line("line 2"));
  EXPECT_FALSE(has_line("line 3"));
  dut_.press(Key::kPageUp, &console);
  dut_.press(Key::kPageDown, &console);
  EXPECT_TRUE(has_line("line 4")) << "8 - 5 lines back";
  EXPECT_FALSE(has_line("line 5"));
  dut_.press(Key::kDown, &console);
  EXPECT_TRUE(has_line("line 7")) << "another command's output is shown from its end";
}

}  // namespace live_view_test
}  // namespace nodmap::procman
