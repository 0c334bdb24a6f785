// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace nodmap::slam2d {

/// Runs one piece of work at a time, at once or on another thread: the algorithm that needs it
/// knows no threads. What is computed does not depend on when it runs.
class Executor {
 public:
  Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  /// Returns only when no work is running.
  virtual ~Executor() = default;

  /// Begins the work. The last one must have been awaited.
  virtual void start(std::function<void()> work) = 0;
  /// Returns when the work has been done; rethrows its exception.
  virtual void wait() = 0;
};

/// Runs the work when it is started.
class ImmediateExecutor final : public Executor {
 public:
  void start(std::function<void()> work) override { work(); }
  void wait() override {}
};

}  // namespace nodmap::slam2d
