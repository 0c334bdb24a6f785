// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

namespace nodmap::node {

/// Counts the messages of a node: used, rejected (by cause) and lost.
class MessageCounts {
 public:
  void use() { ++used_; }

  /// Counts messages that were valid but could not be used. `cause` is in snake_case; the frequent
  /// ones are `implausible_` and what it is, such as `implausible_scan`, and
  /// `scan_without_odometry`.
  void reject(std::string_view cause, std::int64_t count = 1) {
    if (count == 0) {
      return;
    }
    auto found = rejected_.find(cause);
    if (found == rejected_.end()) {
      found = rejected_.emplace(cause, 0).first;
    }
    found->second += count;
    total_rejected_ += count;
  }

  /// Saturates at the greatest number, because foreign sequence numbers may claim any loss.
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

/// Detects gaps in a stream of sequence numbers.
class SequenceCounter {
 public:
  /// Number of messages lost immediately before this one. A number that does not increase means
  /// that the publisher has restarted, so nothing counts as lost. After a negative number, which no
  /// publisher sends, counting also starts again (so that no difference can overflow).
  [[nodiscard]] std::int64_t lost_before(std::int64_t seq) {
    const std::int64_t gap = started_ && last_ >= 0 && seq > last_ ? seq - last_ - 1 : 0;
    started_ = true;
    last_ = seq;
    return gap;
  }

 private:
  bool started_ = false;
  std::int64_t last_ = 0;
};

}  // namespace nodmap::node
