// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <optional>
#include <utility>

namespace nodmap::node {

/// When the result of work in the background is used.
enum class ResultsUsed : std::uint8_t {
  /// At a message that is fixed when the work starts, however long the work takes: a replay gives
  /// the same bytes on any machine. A message waits for a result that is not ready by then.
  kAtFixedMessage,
  /// At the first message after it is ready: no message waits, so none are lost behind a slow disk.
  kWhenReady
};

/// Runs one piece of work at a time on a thread of its own, while messages are handled. Until its
/// result is taken nobody else may use the data that the work uses.
template <class Result>
class BackgroundJob {
 public:
  explicit BackgroundJob(ResultsUsed results_used = ResultsUsed::kAtFixedMessage)
      : results_used_(results_used) {}

  /// Starts `work()`. The last result must have been taken. `messages_until_due` is the number of
  /// messages for ResultsUsed::kAtFixedMessage.
  template <class Work>
  void start(Work work, int messages_until_due) {
    result_ = std::async(std::launch::async, std::move(work));
    messages_until_due_ = messages_until_due;
  }

  /// Whether there is work whose result has not been taken.
  [[nodiscard]] bool is_running() const { return result_.valid(); }

  /// Counts one message. Returns the result if it is to be used at this one.
  [[nodiscard]] std::optional<Result> count_message() {
    if (results_used_ == ResultsUsed::kWhenReady) {
      return is_ready() ? take() : std::nullopt;
    }
    return result_.valid() && --messages_until_due_ <= 0 ? take() : std::nullopt;
  }

  /// For a message that needs the result. With kAtFixedMessage waits for it; with kWhenReady
  /// returns it only if it is ready, and the caller tries again at a later message.
  [[nodiscard]] std::optional<Result> take_early() {
    return results_used_ == ResultsUsed::kAtFixedMessage || is_ready() ? take() : std::nullopt;
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
  [[nodiscard]] bool is_ready() const {
    return result_.valid() &&
           result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }

  ResultsUsed results_used_;
  std::future<Result> result_;
  int messages_until_due_ = 0;
};

}  // namespace nodmap::node
