// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

namespace nodmap::node {

/// What became of the messages a node was given: used, rejected and why, lost on the way.
class MessageCounts {
 public:
  void use() { ++used_; }

  /// A message that was valid but could not be used; `cause` is a snake_case word.
  void reject(std::string_view cause) {
    const auto found = rejected_.find(cause);
    if (found != rejected_.end()) {
      ++found->second;
    } else {
      rejected_.emplace(cause, 1);
    }
    ++total_rejected_;
  }

  /// Numbers of others' messages may claim any loss: the count stays at the greatest there is.
  void lose(std::int64_t count) {
    lost_ += std::min(count, std::numeric_limits<std::int64_t>::max() - lost_);
  }

  [[nodiscard]] std::int64_t used() const { return used_; }
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t total_rejected() const { return total_rejected_; }
  [[nodiscard]] const std::map<std::string, std::int64_t, std::less<>>& rejected() const {
    return rejected_;
  }

 private:
  std::int64_t used_ = 0;
  std::int64_t lost_ = 0;
  std::int64_t total_rejected_ = 0;
  std::map<std::string, std::int64_t, std::less<>> rejected_;
};

/// Notices gaps in a stream of sequence numbers.
class SequenceCounter {
 public:
  /// How many messages were lost just before this one. A number that does not go up is a publisher
  /// that started again: no loss is claimed. Nobody counts below zero: after such a number, too,
  /// counting starts again (and the difference of what is left cannot overflow).
  [[nodiscard]] std::int64_t lost_before(std::int64_t seq) {
    const std::int64_t gap = started_ && last_ >= 0 && seq > last_ ? seq - last_ - 1 : 0;
    started_ = true;
    last_ = seq;
    return gap;
  }

  /// Whether a publisher that now sends `seq` has begun to count anew since the last message.
  [[nodiscard]] bool falls_back(std::int64_t seq) const { return started_ && seq < last_; }

 private:
  bool started_ = false;
  std::int64_t last_ = 0;
};

}  // namespace nodmap::node
