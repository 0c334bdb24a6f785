// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/topic_store.hpp"

#include <algorithm>

namespace nodmap::foxglove {

std::size_t TopicStore::add(Topic topic) {
  topics_.push_back(std::move(topic));
  queues_.emplace_back();
  return topics_.size() - 1;
}

void TopicStore::post(std::size_t topic, time::Timestamp stamp, Post::Encode encode,
                      std::size_t weight) {
  Queue& queue = queues_[topic];
  make_room(queue, topics_[topic], weight);
  auto post = std::make_shared<Post>(stamp, std::move(encode));
  queue.posts.push_back({queue.next_number, weight, post});
  queue.weight += weight;
  ++queue.next_number;
  if (listener_) {
    listener_(topic, *post);
  }
}

void TopicStore::make_room(Queue& queue, const Topic& topic, std::size_t weight) {
  if (topic.keep == Keep::kNewest) {
    queue.posts.clear();
    queue.weight = 0;
    return;
  }
  while (!queue.posts.empty() && queue.weight + weight > topic.max_weight) {
    queue.weight -= queue.posts.front().weight;
    queue.posts.pop_front();
    ++dropped_;
  }
}

std::shared_ptr<Post> TopicStore::next(std::size_t topic, std::uint64_t& cursor) const {
  const std::deque<Kept>& posts = queues_[topic].posts;
  const auto found = std::ranges::lower_bound(posts, cursor, {}, &Kept::number);
  if (found == posts.end()) {
    return nullptr;
  }
  cursor = found->number + 1;
  return found->post;
}

void TopicStore::clear() {
  for (std::size_t topic = 0; topic < queues_.size(); ++topic) {
    clear(topic);
  }
}

void TopicStore::clear(std::size_t topic) {
  queues_[topic].posts.clear();
  queues_[topic].weight = 0;
}

}  // namespace nodmap::foxglove
