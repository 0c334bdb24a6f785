// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/board.hpp"

#include <gtest/gtest.h>

namespace nodmap::foxglove {
namespace {

Post::Encode says(const std::string& text) {
  return [text] { return text; };
}

TEST(Board, AReaderSeesTheNewestOnly) {
  Board board;
  const std::size_t topic = board.add({"POSE", "s"});
  std::uint64_t cursor = 0;
  EXPECT_EQ(board.next(topic, cursor), nullptr);
  board.post(topic, 1, says("a"));
  board.post(topic, 2, says("b"));
  EXPECT_EQ(board.next(topic, cursor)->text(), "b");
  EXPECT_EQ(board.next(topic, cursor), nullptr);
  board.post(topic, 3, says("c"));
  EXPECT_EQ(board.next(topic, cursor)->text(), "c");
}

TEST(Board, ALateReaderGetsEverythingOfACollection) {
  Board board;
  const std::size_t topic = board.add({"CLOUD", "s", Keep::kAll, 100});
  board.post(topic, 1, says("a"));
  board.post(topic, 2, says("b"));
  std::uint64_t cursor = 0;
  EXPECT_EQ(board.next(topic, cursor)->text(), "a");
  EXPECT_EQ(board.next(topic, cursor)->text(), "b");
  EXPECT_EQ(board.next(topic, cursor), nullptr);
}

TEST(Board, ACollectionStaysWithinItsLimit) {
  Board board;
  const std::size_t topic = board.add({"CLOUD", "s", Keep::kAll, 10});
  for (int i = 0; i < 5; ++i) {
    board.post(topic, i, says(std::to_string(i)), 4);
  }
  std::uint64_t cursor = 0;
  EXPECT_EQ(board.next(topic, cursor)->text(), "3");
  EXPECT_EQ(board.next(topic, cursor)->text(), "4");
  EXPECT_EQ(board.next(topic, cursor), nullptr);
  EXPECT_EQ(board.dropped(), 3);
}

TEST(Board, TextIsMadeWhenItIsWantedAndOnce) {
  Board board;
  const std::size_t topic = board.add({"SCAN", "s"});
  int made = 0;
  const auto make = [&made] {
    ++made;
    return std::string("x");
  };
  board.post(topic, 1, make);
  board.post(topic, 2, make);
  EXPECT_EQ(made, 0);
  std::uint64_t one = 0;
  std::uint64_t other = 0;
  EXPECT_EQ(board.next(topic, one)->text(), "x");
  EXPECT_EQ(board.next(topic, other)->text(), "x");
  EXPECT_EQ(made, 1);
}

TEST(Board, AfterAClearReadersGoOnWithWhatIsNew) {
  Board board;
  const std::size_t topic = board.add({"SCAN", "s"});
  std::uint64_t cursor = 0;
  board.post(topic, 1, says("old"));
  (void)board.next(topic, cursor);
  board.clear();
  EXPECT_EQ(board.next(topic, cursor), nullptr);
  board.post(topic, 1, says("new"));
  EXPECT_EQ(board.next(topic, cursor)->text(), "new");
}

TEST(Board, AListenerMissesNothing) {
  Board board;
  const std::size_t topic = board.add({"SCAN", "s"});
  std::string heard;
  board.listen([&heard](std::size_t, Post& post) { heard += post.text(); });
  board.post(topic, 1, says("a"));
  board.post(topic, 2, says("b"));
  EXPECT_EQ(heard, "ab");
}

}  // namespace
}  // namespace nodmap::foxglove
