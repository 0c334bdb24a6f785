// SPDX-License-Identifier: BSD-3-Clause
// Loops that are closed at once, late or on a thread of their own give the same poses and map.
#include "modules/slam2d/executor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "modules/slam2d/grid/keyframe_grid.hpp"
#include "modules/slam2d/grid/trinary_grid.hpp"
#include "modules/slam2d/slam2d.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/slam2d_node_fixture.hpp"
#include "modules/slam2d/test/track.hpp"
#include "modules/slam2d/thread_executor.hpp"
#include "nodmap/pose_graph_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::slam2d {
namespace executor_test {

using geometry::SE2;
using test::Slam2dNodeTest;

constexpr time::Duration kScanPeriod = 50ms;

// Runs the work only when somebody waits for it.
class LateExecutor final : public Executor {
 public:
  explicit LateExecutor(int& waits) : waits_(waits) {}
  void start(std::function<void()> work) override { work_ = std::move(work); }
  void wait() override {
    ++waits_;
    work_();
  }

 private:
  int& waits_;
  std::function<void()> work_;
};

// One and a half times around a corridor, from its lower left corner. In a rotation there is a
// keyframe every 100 ms, on the straights every 200 ms or later.
std::vector<SE2> steps_around_corridor() {
  std::vector<SE2> steps;
  for (const int length_m : {14, 10, 14, 10, 14, 10}) {
    steps.insert(steps.end(), static_cast<std::size_t>(length_m) * 10, SE2{0.1, 0.0, 0.0});
    steps.insert(steps.end(), 10, SE2{0.0, 0.0, geometry::deg_to_rad(9.0)});
  }
  return steps;
}

struct Result {
  std::vector<SE2> online;
  std::vector<SE2> trajectory;
  std::vector<CellState> grid;
  BackEndMetrics loops;
};

// Odometry counts 3 % too much distance. On the way a second is missing, after which the local
// submap is searched.
Result mapped_by(std::unique_ptr<Executor> executor) {
  const Slam2dParams params;
  Slam2d slam(params, std::move(executor));
  LevelScanInput input(params.level_scans);
  test::Scanner scanner;
  KeyframeGrid map(params.grid.cell_size_m);
  Result result;
  SE2 truth;
  SE2 odom;
  time::Timestamp stamp{};
  for (const SE2& step : steps_around_corridor()) {
    truth = truth * step;
    odom = odom * SE2{1.03 * step.x, 0.0, step.yaw};
    stamp += result.online.size() == 300 ? time::Duration(1s) : kScanPeriod;
    input.add_odometry(stamp, geometry::to_se3(odom));
    input.add_scan(scanner.scan(test::ring_corridor(), truth, stamp));
    while (const std::optional<LevelScan> scan = input.next()) {
      result.online.push_back(slam.add_scan(*scan).value().T_map_base);
      if (const DroppedKeyframes* const dropped = slam.dropped_keyframes()) {
        map.drop(*dropped);
      }
      map.draw_new(slam.keyframes());
    }
  }
  slam.finish_loops();
  slam.polish();
  map.redraw_all_moved(slam.keyframes());
  result.trajectory = slam.trajectory();
  result.grid = trinary(map.grid()).cells;
  result.loops = slam.back_end().metrics();
  return result;
}

testing::Matcher<const SE2&> is_exactly(const SE2& pose) {
  return testing::AllOf(testing::Field(&SE2::x, pose.x), testing::Field(&SE2::y, pose.y),
                        testing::Field(&SE2::yaw, pose.yaw));
}

void expect_same(const std::vector<SE2>& poses, const std::vector<SE2>& others) {
  ASSERT_EQ(poses.size(), others.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ASSERT_THAT(poses[i], is_exactly(others[i])) << i;
  }
}

TEST(Executor, LoopsClosedAtOnceLateOrOnAThreadGiveTheSameBytes) {
  int waits = 0;
  const Result at_once = mapped_by(std::make_unique<ImmediateExecutor>());
  const Result late = mapped_by(std::make_unique<LateExecutor>(waits));
  const Result on_thread = mapped_by(std::make_unique<ThreadExecutor>());
  EXPECT_GT(at_once.loops.loops_tracked + at_once.loops.loops_searched, 20);
  EXPECT_GT(at_once.loops.searches, 0);
  EXPECT_GT(at_once.loops.optimisations, 5);
  EXPECT_GT(waits, 100);
  for (const Result* const other : {&late, &on_thread}) {
    expect_same(other->online, at_once.online);
    expect_same(other->trajectory, at_once.trajectory);
    EXPECT_EQ(other->grid, at_once.grid);
  }
}

// Loops that take long are awaited only when 200 ms have passed, or at the next keyframe.
TEST(Executor, NoScanWaitsForTheLoopsBeforeTheyAreDue) {
  int waits = 0;
  const Slam2dParams params;
  Slam2d slam(params, std::make_unique<LateExecutor>(waits));
  LevelScanInput input(params.level_scans);
  test::Scanner scanner;
  const auto add = [&](time::Duration since_epoch, const SE2& pose) {
    const time::Timestamp stamp(since_epoch);
    input.add_odometry(stamp, geometry::to_se3(pose));
    input.add_scan(scanner.scan(test::room(), pose, stamp));
    const std::optional<LevelScan> scan = input.next();
    return scan && slam.add_scan(*scan).value().is_keyframe;
  };
  EXPECT_TRUE(add(0ms, {}));
  for (const time::Duration since_epoch : {50ms, 100ms, 150ms}) {
    EXPECT_FALSE(add(since_epoch, {}));
    EXPECT_EQ(waits, 0);
  }
  EXPECT_FALSE(add(200ms, {}));
  EXPECT_EQ(waits, 1);
  EXPECT_TRUE(add(250ms, {0.31, 0.0, 0.0}));
  EXPECT_EQ(waits, 1);
  EXPECT_TRUE(add(350ms, {0.62, 0.0, 0.0}));
  EXPECT_EQ(waits, 2);
  slam.finish_loops();
  EXPECT_EQ(waits, 3);
  slam.finish_loops();
  EXPECT_EQ(waits, 3) << "nothing to wait for";
}

TEST(Executor, AnExceptionOfTheWorkComesWithWaiting) {
  ThreadExecutor executor;
  executor.start([] { throw std::runtime_error("no"); });
  EXPECT_THROW(executor.wait(), std::runtime_error);
  bool is_done = false;
  executor.start([&is_done] { is_done = true; });
  executor.wait();
  EXPECT_TRUE(is_done);
}

// As while a map is saved: the copy is drawn anew and destroyed, while the map grows.
TEST(Executor, ASnapshotOfTheGridIsDrawnOnAnotherThread) {
  const std::vector<Keyframe> keyframes = [] {
    Slam2d slam({}, std::make_unique<ImmediateExecutor>());
    LevelScanInput input({});
    test::Scanner scanner;
    for (int i = 0; i < 10; ++i) {
      const SE2 pose{0.31 * i, 0.0, 0.0};
      const time::Timestamp stamp(1s * i);
      input.add_odometry(stamp, geometry::to_se3(pose));
      input.add_scan(scanner.scan(test::corridor(), pose, stamp));
      if (const std::optional<LevelScan> scan = input.next()) {
        EXPECT_TRUE(slam.add_scan(*scan));
      }
    }
    return std::vector(slam.keyframes().begin(), slam.keyframes().end());
  }();
  ASSERT_GE(keyframes.size(), 4U);
  KeyframeGrid map(0.05);
  ThreadExecutor executor;
  for (std::size_t end = 1; end <= keyframes.size(); ++end) {
    map.draw_new({keyframes.data(), end});
    executor.wait();
    auto moved = keyframes;
    for (Keyframe& keyframe : moved) {
      keyframe.T_map_base.x += 0.5;
    }
    executor.start([snapshot = std::make_shared<KeyframeGrid>(map.snapshot()), moved] {
      snapshot->redraw_all_moved(moved);
    });
  }
  executor.wait();
  KeyframeGrid expected(0.05);
  expected.draw_new(keyframes);
  EXPECT_EQ(trinary(map.grid()).cells, trinary(expected.grid()).cells);
}

// While loops are closed the node publishes the graph, and saves.
TEST_F(Slam2dNodeTest, PublishesAndSavesTheMapWhileLoopsAreClosed) {
  const nodmap::test::TemporaryDir dir;
  context_.out_dir = dir.path();
  SE2 truth;
  for (std::int64_t i = 0; i < 240; ++i) {
    truth = truth * SE2{0.05, 0.0, 0.06};
    put_odometry(kScanPeriod * i, truth);
    put_scan(kScanPeriod * i, truth);
    if (i % 50 == 49) {
      bus_.deliver("SAVE_REQUEST", nodmap::save_request_t{});
    }
  }
  EXPECT_GT(bus_.count("POSE_GRAPH"), 3U);
  node_.finish();
  EXPECT_NEAR(bus_.last<nodmap::pose_t>("POSE_2D").position_m[0], truth.x, 0.06);
  EXPECT_GT(node_.metrics()["loops"]["optimisations"], 0);
}

}  // namespace executor_test
}  // namespace nodmap::slam2d
