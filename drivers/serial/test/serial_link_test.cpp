// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/serial_link.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "tests/support/data_dir.hpp"
#include "tests/support/pty_pair.hpp"

namespace nodmap::serial {
namespace serial_link_test {

constexpr time::Timestamp kStart{1'700'000'000s};

time::Moment at(time::Duration since_start) {
  return {kStart + since_start, time::SteadyTime(since_start)};
}

// A link, and the calls of its driver's handlers.
struct Rig {
  explicit Rig(SerialLink::Opener open)
      : link("device", std::move(open),
             {.opened = [this](const time::Moment&) { ++opened; },
              .received =
                  [this](std::span<const std::uint8_t> bytes, const time::Moment&) {
                    received.insert(received.end(), bytes.begin(), bytes.end());
                  },
              .lost = [this] { ++lost; }}) {}

  // Waits until the line is readable: bytes, or its end, have come.
  void await_input() const {
    pollfd entry{link.poll_handle(), POLLIN, 0};
    ASSERT_EQ(::poll(&entry, 1, 5000), 1);
  }

  int opened = 0;
  int lost = 0;
  std::string received;
  SerialLink link;
};

TEST(SerialLink, TriesAgainWithGrowingPauses) {
  int attempts = 0;
  Rig rig([&attempts]() -> OpenResult {
    ++attempts;
    return {nullptr, "no such device"};
  });
  // Asked every millisecond for 10 s: at 0, 0.1, 0.3, 0.7, 1.5, 3.1, 6.3 s.
  for (time::Duration now{}; now <= 10s; now += 1ms) {
    rig.link.poll(at(now));
    EXPECT_FALSE(rig.link.is_open());
  }
  EXPECT_EQ(attempts, 7);
  EXPECT_EQ(rig.link.error(), "no such device");
  EXPECT_EQ(rig.link.poll_handle(), -1);
  EXPECT_EQ(rig.link.reconnects(), 0);
  EXPECT_EQ(rig.opened, 0);
  EXPECT_EQ(rig.lost, 0);
}

TEST(SerialLink, ADeviceThatFailsAtOnceEachTimeDoesNotEscapeTheBackOff) {
  const test::PtyPair pty;
  int attempts = 0;
  Rig rig([&]() -> OpenResult {
    ++attempts;
    return open_serial_port({pty.name()});
  });
  for (time::Duration now{}; now <= 10s; now += 1ms) {
    rig.link.poll(at(now));
    rig.link.give_up(at(now), "mute");
  }
  EXPECT_EQ(attempts, 7);
  EXPECT_EQ(rig.link.reconnects(), 6);
  EXPECT_EQ(rig.link.error(), "mute");
  EXPECT_EQ(rig.opened, 7);
  EXPECT_EQ(rig.lost, 7);
}

TEST(SerialLink, AfterALongLifeTheFirstAttemptIsSoon) {
  const test::PtyPair pty;
  Rig rig(port_opener(pty.name(), 115200));
  rig.link.poll(at(0s));
  ASSERT_TRUE(rig.link.is_open());
  EXPECT_EQ(rig.link.error(), "");
  rig.link.give_up(at(60s), "mute");
  rig.link.poll(at(60s + BackOff::kFirst - 1us));
  EXPECT_FALSE(rig.link.is_open());
  rig.link.poll(at(60s + BackOff::kFirst));
  EXPECT_TRUE(rig.link.is_open());
  EXPECT_EQ(rig.link.reconnects(), 1);
}

// As with udev: the link disappears with the device, and points to another one after replugging.
// Meanwhile another device may already have the old name.
TEST(SerialLink, FindsTheDeviceUnderItsNewName) {
  const test::TemporaryDir dir;
  const std::filesystem::path link = dir.path() / "scanner";
  std::optional<test::PtyPair> pty(std::in_place);
  std::filesystem::create_symlink(pty->name(), link);
  Rig rig(port_opener(link.string(), 115200));
  rig.link.poll(at(0s));
  ASSERT_TRUE(rig.link.is_open()) << rig.link.error();
  pty->unplug();
  rig.await_input();
  rig.link.poll(at(1ms));
  EXPECT_EQ(rig.lost, 1);
  EXPECT_EQ(rig.link.error(), "the line is disconnected");
  std::filesystem::remove(link);
  rig.link.poll(at(101ms));
  EXPECT_FALSE(rig.link.is_open());
  EXPECT_NE(rig.link.error(), "the line is disconnected") << "why it cannot be opened is told";

  pty.emplace();
  std::filesystem::create_symlink(pty->name(), link);
  rig.link.poll(at(301ms));
  ASSERT_TRUE(rig.link.is_open()) << rig.link.error();
  pty->send("x");
  rig.await_input();
  rig.link.poll(at(302ms));
  EXPECT_EQ(rig.received, "x");
  EXPECT_EQ(rig.opened, 2);
}

TEST(SerialLink, WritesAllBytesWithAndWithoutAPauseBetweenThem) {
  const test::PtyPair pty;
  Rig rig(port_opener(pty.name(), 115200));
  const std::vector<std::uint8_t> bytes{'a', 'b', 'c'};
  EXPECT_FALSE(rig.link.write(bytes, at(0s), {})) << "not open yet";
  EXPECT_EQ(rig.lost, 0);
  rig.link.poll(at(0s));
  EXPECT_TRUE(rig.link.write(bytes, at(0s), {}));
  EXPECT_TRUE(rig.link.write(bytes, at(0s), {.byte_pause = 1us}));
  EXPECT_EQ(pty.receive_text(6), "abcabc");
}

TEST(SerialLink, ALineThatAcceptsNoBytesIsLost) {
  const test::PtyPair pty;
  Rig rig(port_opener(pty.name(), 115200));
  rig.link.poll(at(0s));
  const std::vector<std::uint8_t> more_than_fits(1'000'000, 'x');
  EXPECT_FALSE(rig.link.write(more_than_fits, at(0s), {.timeout = 20ms}));
  EXPECT_FALSE(rig.link.is_open());
  EXPECT_EQ(rig.link.error(), "the line does not accept bytes");
  EXPECT_EQ(rig.lost, 1);
}

TEST(SerialLink, OnceEndedItStaysClosed) {
  const test::PtyPair pty;
  Rig rig(port_opener(pty.name(), 115200));
  rig.link.poll(at(0s));
  rig.link.end();
  EXPECT_EQ(rig.lost, 1);
  EXPECT_EQ(rig.link.poll_handle(), -1);
  rig.link.poll(at(60s));
  EXPECT_FALSE(rig.link.is_open());
}

TEST(SerialLink, ANewRateDropsBytesReceivedAtTheOldOne) {
  const test::PtyPair pty;
  Rig rig(port_opener(pty.name(), 9600));
  rig.link.poll(at(0s));
  pty.send("old");
  rig.await_input();
  rig.link.set_baud(500'000);
  EXPECT_EQ(pty.baud(), 500'000);
  pty.send("new");
  rig.await_input();
  rig.link.poll(at(1ms));
  EXPECT_EQ(rig.received, "new");
}

TEST(BackOff, DoublesFromATenthOfASecondToFiveSeconds) {
  BackOff back_off;
  time::SteadyTime now;
  EXPECT_TRUE(back_off.due(now));
  std::vector<time::Duration> waits;
  for (int i = 0; i < 8; ++i) {
    back_off.failed(now);
    EXPECT_FALSE(back_off.due(now));
    waits.push_back(back_off.wait(now));
    now += waits.back();
    EXPECT_TRUE(back_off.due(now));
    EXPECT_EQ(back_off.wait(now), 0us);
  }
  EXPECT_EQ(waits,
            (std::vector<time::Duration>{100ms, 200ms, 400ms, 800ms, 1600ms, 3200ms, 5s, 5s}));
}

TEST(BackOff, PausesNoLongerThanItsLongest) {
  BackOff back_off(300ms);
  constexpr time::SteadyTime now;
  for (const time::Duration pause : {100ms, 200ms, 300ms, 300ms}) {
    back_off.failed(now);
    EXPECT_EQ(back_off.wait(now), pause);
  }
}

TEST(BackOff, SuccessStartsOver) {
  BackOff back_off;
  constexpr time::SteadyTime kBegin;
  back_off.failed(kBegin);
  back_off.failed(kBegin + 100ms);
  back_off.succeeded();
  EXPECT_TRUE(back_off.due(kBegin));
  back_off.failed(kBegin + 1s);
  EXPECT_EQ(back_off.wait(kBegin + 1s), BackOff::kFirst);
}

}  // namespace serial_link_test
}  // namespace nodmap::serial
