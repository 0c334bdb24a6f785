// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::foxglove {

/// One message of a topic. Its text is created once, when the first reader wants it.
class Post {
 public:
  using Encode = std::function<std::string()>;

  Post(time::Timestamp stamp, Encode encode) : stamp_(stamp), encode_(std::move(encode)) {}

  [[nodiscard]] time::Timestamp stamp() const { return stamp_; }
  [[nodiscard]] const std::string& text() {
    if (encode_) {
      text_ = encode_();
      encode_ = nullptr;  // also frees the captured message
    }
    return text_;
  }

 private:
  time::Timestamp stamp_;
  Encode encode_;
  std::string text_;
};

/// Which messages a topic keeps for its readers.
enum class Keep : std::uint8_t {
  kNewest,  ///< the newest message: it replaces the older ones (a pose, a map)
  kAll      ///< all messages, up to a limit: each adds to the others (keyframes, log lines)
};

struct Topic {
  std::string name;
  std::string schema_name;
  Keep keep = Keep::kNewest;
  std::size_t max_weight = 0;  ///< total weight that kAll keeps; the oldest are dropped first
};

/// Stores the newest messages of every topic for any number of readers. A reader has only a cursor,
/// so a slow one costs no memory and delays no other; it misses messages that have been replaced
/// meanwhile.
class TopicStore {
 public:
  using Listener = std::function<void(std::size_t topic, Post& post)>;

  /// Returns the topic's number, from 0. Topics are added once, before the first post.
  std::size_t add(Topic topic);

  void post(std::size_t topic, time::Timestamp stamp, Post::Encode encode, std::size_t weight = 1);

  /// The next post of the topic after the cursor; advances the cursor. Null if there is nothing
  /// new.
  [[nodiscard]] std::shared_ptr<Post> next(std::size_t topic, std::uint64_t& cursor) const;

  /// Forgets all posts, because a recording starts again. Cursors stay valid.
  void clear();
  /// Forgets the posts of one topic.
  void clear(std::size_t topic);

  /// Sets a function that is called with every post, for a reader that must not miss any.
  void listen(Listener listener) { listener_ = std::move(listener); }

  [[nodiscard]] const std::vector<Topic>& topics() const { return topics_; }
  /// Number of posts dropped from kAll topics at their limit.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  struct Kept {
    std::uint64_t number = 0;
    std::size_t weight = 0;
    std::shared_ptr<Post> post;
  };
  struct Queue {
    std::uint64_t next_number = 0;
    std::size_t weight = 0;
    std::deque<Kept> posts;
  };

  void make_room(Queue& queue, const Topic& topic, std::size_t weight);

  std::vector<Topic> topics_;
  std::vector<Queue> queues_;
  Listener listener_;
  std::int64_t dropped_ = 0;
};

}  // namespace nodmap::foxglove
