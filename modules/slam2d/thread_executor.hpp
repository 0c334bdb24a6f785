// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "common/node/background_job.hpp"
#include "modules/slam2d/executor.hpp"

namespace nodmap::slam2d {

/// Runs the work on a thread of its own.
class ThreadExecutor final : public Executor {
 public:
  void start(std::function<void()> work) override {
    const auto run = [work = std::move(work)] {
      work();
      return true;
    };
    job_.start(run, 0);
  }
  void wait() override { (void)job_.take(); }

 private:
  node::BackgroundJob<bool> job_;
};

}  // namespace nodmap::slam2d
