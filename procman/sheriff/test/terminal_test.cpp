// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/terminal.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "common/formats/file_descriptor.hpp"

namespace nodmap::procman {
namespace terminal_test {

// A pseudo-terminal as stdin and stdout of this process. `theirs` is the side of the person.
class PseudoTerminal : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_GE(theirs_.get(), 0);
    ASSERT_EQ(::grantpt(theirs_.get()), 0);
    ASSERT_EQ(::unlockpt(theirs_.get()), 0);
    const formats::FileDescriptor ours(::open(::ptsname(theirs_.get()), O_RDWR | O_NOCTTY));
    ASSERT_GE(ours.get(), 0);
    std::fflush(stdout);
    ::dup2(ours.get(), STDIN_FILENO);
    ::dup2(ours.get(), STDOUT_FILENO);
  }

  void TearDown() override {
    std::fflush(stdout);
    ::dup2(stdin_before_.get(), STDIN_FILENO);
    ::dup2(stdout_before_.get(), STDOUT_FILENO);
  }

  static termios settings() {
    termios now{};
    EXPECT_EQ(::tcgetattr(STDIN_FILENO, &now), 0);
    return now;
  }

  // What was written up to `end`; waits for that for ten seconds at most.
  std::string written_until(const std::string& end) {
    std::string text;
    std::array<char, 4096> buffer{};
    pollfd waiting{.fd = theirs_.get(), .events = POLLIN, .revents = 0};
    while (text.find(end) == std::string::npos && ::poll(&waiting, 1, 10'000) > 0) {
      const ssize_t size = ::read(theirs_.get(), buffer.data(), buffer.size());
      text.append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    }
    return text;
  }

  formats::FileDescriptor theirs_{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)};
  formats::FileDescriptor stdin_before_{::dup(STDIN_FILENO)};
  formats::FileDescriptor stdout_before_{::dup(STDOUT_FILENO)};
};

TEST_F(PseudoTerminal, ControlSIsAKeyLikeOthersAndItsMeaningIsRestored) {
  ASSERT_NE(settings().c_iflag & IXON, 0U);
  {
    const Terminal dut;
    EXPECT_EQ(settings().c_iflag & IXON, 0U);
  }
  EXPECT_NE(settings().c_iflag & IXON, 0U);
}

// A sheriff that waited for a terminal would give no orders meanwhile.
TEST_F(PseudoTerminal, AFrameThatTheTerminalDoesNotTakeIsLeftOut) {
  Terminal dut;
  ASSERT_EQ(::tcflow(STDOUT_FILENO, TCOOFF), 0);
  dut.draw({{"first", Tone::kPlain}}, {});
  dut.draw({{"second", Tone::kPlain}}, {});
  ASSERT_EQ(::tcflow(STDOUT_FILENO, TCOON), 0);
  dut.draw({{"third", Tone::kPlain}}, {});
  const std::string shown = written_until("third");
  EXPECT_EQ(shown.find("second"), std::string::npos) << shown;
  EXPECT_NE(shown.find("third"), std::string::npos) << shown;
}

TEST(Keys, AreReadOneByOne) {
  std::string typed = "x\x1B[A\x1B[BsSqr";
  EXPECT_EQ(take_key(typed), Key::kUp);
  EXPECT_EQ(take_key(typed), Key::kDown);
  EXPECT_EQ(take_key(typed), Key::kStart);
  EXPECT_EQ(take_key(typed), Key::kStartGroup);
  EXPECT_EQ(take_key(typed), Key::kQuit);
  EXPECT_EQ(take_key(typed), Key::kRestart);
  EXPECT_FALSE(take_key(typed).has_value());
}

TEST(Keys, DigitsAreScriptsAndPagesScroll) {
  std::string typed = "1\x1B[5~9\x1B[6~0";
  EXPECT_EQ(take_key(typed), Key::kFirstScript);
  EXPECT_EQ(take_key(typed), Key::kPageUp);
  EXPECT_EQ(take_key(typed), Key::kLastScript);
  EXPECT_EQ(take_key(typed), Key::kPageDown);
  EXPECT_FALSE(take_key(typed).has_value());
}

// Otherwise F5 would start scripts 1 and 5. Its bytes may arrive one by one.
TEST(Keys, AFunctionKeyIsNotReadAsDigits) {
  std::string typed;
  for (const char* key : {"\x1B[15~", "\x1B[1;5A", "\x1BOS", "\x1B[3~"}) {
    for (const char* byte = key; *byte != '\0'; ++byte) {
      typed += *byte;
      EXPECT_FALSE(take_key(typed).has_value()) << key + 1;
    }
    EXPECT_TRUE(typed.empty()) << key + 1;
  }
  typed = "\x1Bq";  // Escape, then q
  EXPECT_EQ(take_key(typed), Key::kQuit);
}

}  // namespace terminal_test
}  // namespace nodmap::procman
