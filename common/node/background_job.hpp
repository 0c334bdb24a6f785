// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <future>
#include <optional>
#include <utility>

namespace nodmap::node {

/// Runs one piece of work at a time on a thread of its own, while messages are handled. The number
/// of messages after which the result is taken is fixed when the work starts, however long the work
/// takes, so that a replay gives the same bytes on any machine. Until then nobody else may use the
/// data that the work uses.
template <class Result>
class BackgroundJob {
 public:
  /// Starts `work()`. The last result must have been taken.
  template <class Work>
  void start(Work work, int messages_until_due) {
    result_ = std::async(std::launch::async, std::move(work));
    messages_until_due_ = messages_until_due;
  }

  /// Whether there is work whose result has not been taken.
  [[nodiscard]] bool is_running() const { return result_.valid(); }

  /// Counts one message. Returns the result when it is due, waiting for it if need be.
  [[nodiscard]] std::optional<Result> count_message() {
    return result_.valid() && --messages_until_due_ <= 0 ? take() : std::nullopt;
  }

  /// Waits for the result and returns it; empty if there is no work. Rethrows an exception of the
  /// work.
  [[nodiscard]] std::optional<Result> take() {
    return result_.valid() ? std::optional(result_.get()) : std::nullopt;
  }

  /// Waits until the work has ended; does not take the result.
  void wait() const {
    if (result_.valid()) {
      result_.wait();
    }
  }

 private:
  std::future<Result> result_;
  int messages_until_due_ = 0;
};

}  // namespace nodmap::node
