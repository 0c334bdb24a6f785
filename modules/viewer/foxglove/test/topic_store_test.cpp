// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/topic_store.hpp"

#include <gtest/gtest.h>

namespace nodmap::foxglove {
namespace topic_store_test {

Post::Encode says(const std::string& text) {
  return [text] { return text; };
}

TEST(TopicStore, AReaderGetsOnlyTheNewestMessage) {
  TopicStore store;
  const std::size_t topic = store.add({"POSE", "s"});
  std::uint64_t cursor = 0;
  EXPECT_EQ(store.next(topic, cursor), nullptr);
  store.post(topic, time::from_utime(1), says("a"));
  store.post(topic, time::from_utime(2), says("b"));
  EXPECT_EQ(store.next(topic, cursor)->text(), "b");
  EXPECT_EQ(store.next(topic, cursor), nullptr);
  store.post(topic, time::from_utime(3), says("c"));
  EXPECT_EQ(store.next(topic, cursor)->text(), "c");
}

TEST(TopicStore, ALateReaderGetsTheWholeCollection) {
  TopicStore store;
  const std::size_t topic = store.add({"CLOUD", "s", Keep::kAll, 100});
  store.post(topic, time::from_utime(1), says("a"));
  store.post(topic, time::from_utime(2), says("b"));
  std::uint64_t cursor = 0;
  EXPECT_EQ(store.next(topic, cursor)->text(), "a");
  EXPECT_EQ(store.next(topic, cursor)->text(), "b");
  EXPECT_EQ(store.next(topic, cursor), nullptr);
}

TEST(TopicStore, ACollectionStaysWithinItsLimit) {
  TopicStore store;
  const std::size_t topic = store.add({"CLOUD", "s", Keep::kAll, 10});
  for (int i = 0; i < 5; ++i) {
    store.post(topic, time::from_utime(i), says(std::to_string(i)), 4);
  }
  std::uint64_t cursor = 0;
  EXPECT_EQ(store.next(topic, cursor)->text(), "3");
  EXPECT_EQ(store.next(topic, cursor)->text(), "4");
  EXPECT_EQ(store.next(topic, cursor), nullptr);
  EXPECT_EQ(store.dropped(), 3);
}

TEST(TopicStore, TextIsProducedOnDemandAndOnlyOnce) {
  TopicStore store;
  const std::size_t topic = store.add({"SCAN", "s"});
  int made = 0;
  const auto make = [&made] {
    ++made;
    return std::string("x");
  };
  store.post(topic, time::from_utime(1), make);
  store.post(topic, time::from_utime(2), make);
  EXPECT_EQ(made, 0);
  std::uint64_t one = 0;
  std::uint64_t other = 0;
  EXPECT_EQ(store.next(topic, one)->text(), "x");
  EXPECT_EQ(store.next(topic, other)->text(), "x");
  EXPECT_EQ(made, 1);
}

TEST(TopicStore, AfterAClearReadersContinueWithNewPosts) {
  TopicStore store;
  const std::size_t topic = store.add({"SCAN", "s"});
  std::uint64_t cursor = 0;
  store.post(topic, time::from_utime(1), says("old"));
  (void)store.next(topic, cursor);
  store.clear();
  EXPECT_EQ(store.next(topic, cursor), nullptr);
  store.post(topic, time::from_utime(1), says("new"));
  EXPECT_EQ(store.next(topic, cursor)->text(), "new");
}

TEST(TopicStore, AListenerGetsEveryMessage) {
  TopicStore store;
  const std::size_t topic = store.add({"SCAN", "s"});
  std::string received;
  store.listen([&received](std::size_t, Post& post) { received += post.text(); });
  store.post(topic, time::from_utime(1), says("a"));
  store.post(topic, time::from_utime(2), says("b"));
  EXPECT_EQ(received, "ab");
}

}  // namespace topic_store_test
}  // namespace nodmap::foxglove
