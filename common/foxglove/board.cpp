// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/board.hpp"

#include <algorithm>

namespace nodmap::foxglove {

std::size_t Board::add(Topic topic) {
  topics_.push_back(std::move(topic));
  shelves_.emplace_back();
  return topics_.size() - 1;
}

void Board::post(std::size_t topic, std::int64_t utime_us, Post::Encode encode,
                 std::size_t weight) {
  Shelf& shelf = shelves_[topic];
  make_room(shelf, topics_[topic], weight);
  auto post = std::make_shared<Post>(utime_us, std::move(encode));
  shelf.posts.push_back({shelf.next_number, weight, post});
  shelf.weight += weight;
  ++shelf.next_number;
  if (listener_) {
    listener_(topic, *post);
  }
}

void Board::make_room(Shelf& shelf, const Topic& topic, std::size_t weight) {
  if (topic.keep == Keep::kNewest) {
    shelf.posts.clear();
    shelf.weight = 0;
    return;
  }
  while (!shelf.posts.empty() && shelf.weight + weight > topic.max_weight) {
    shelf.weight -= shelf.posts.front().weight;
    shelf.posts.pop_front();
    ++dropped_;
  }
}

std::shared_ptr<Post> Board::next(std::size_t topic, std::uint64_t& cursor) const {
  const std::deque<Kept>& posts = shelves_[topic].posts;
  const auto found =
      std::lower_bound(posts.begin(), posts.end(), cursor,
                       [](const Kept& kept, std::uint64_t number) { return kept.number < number; });
  if (found == posts.end()) {
    return nullptr;
  }
  cursor = found->number + 1;
  return found->post;
}

void Board::clear() {
  for (Shelf& shelf : shelves_) {
    shelf.posts.clear();
    shelf.weight = 0;
  }
}

}  // namespace nodmap::foxglove
