// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <future>
#include <optional>
#include <utility>

namespace nodmap::node {

/// Work that runs beside the messages, on a thread of its own, one piece at a time. Its result is
/// taken at a message that is fixed when it starts, not when it happens to be ready: a replay gives
/// the same bytes however fast the machine is. What the work uses nobody else may touch until then.
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

  /// The result now, waiting for it; empty when there is no work. Throws what the work threw.
  [[nodiscard]] std::optional<Result> take() {
    return result_.valid() ? std::optional(result_.get()) : std::nullopt;
  }

  /// Waits until nothing runs; the result stays.
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
