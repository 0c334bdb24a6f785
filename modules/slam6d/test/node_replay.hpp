// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/bus/replay_bus.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/node.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d::node_test {

namespace fs = std::filesystem;

/// A recording that a test writes.
class LogFile {
 public:
  explicit LogFile(const fs::path& file) : writer_(file) {}

  template <class Message>
  void add(time::Timestamp stamp, const std::string& channel, const Message& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    ASSERT_TRUE(writer_.write(time::to_utime(stamp), channel, bytes));
  }

  /// Adds a drive of 4.3 m through a hall at 1 m/s: 320 scans, which are 4 sweeps. From scan
  /// `restart` on, odometry begins at zero again, with its sequence numbers and its pose, as after
  /// a restart of the base driver. `T_odom_world` is the pose of the world in odom at the
  /// beginning. There is odometry with every `odometry_every`th scan before scan `odometry_end`.
  void add_drive(bool with_odometry, std::int64_t restart = 0,
                 const geometry::SE3& T_odom_world = geometry::SE3::Identity(),
                 std::int64_t odometry_every = 1, std::int64_t odometry_end = 320) {
    std::mt19937 random(9);
    const NoddingScanner scanner{.noise_m = 0.01};
    const auto motion = [](time::Timestamp t) { return drive_ahead(1.0, t); };
    for (std::int64_t i = 0; i < 320; ++i) {
      const time::Timestamp stamp(i * NoddingScanner::kPeriod);
      if (with_odometry && i % odometry_every == 0 && i < odometry_end) {
        const std::int64_t first = i < restart ? 0 : restart;
        const geometry::SE3 T_start_odom = motion(time::Timestamp(first * NoddingScanner::kPeriod));
        auto odometry =
            node::write_odometry(stamp, T_odom_world * T_start_odom.inverse() * motion(stamp));
        odometry.odometry_seq = i - first;
        add(stamp, "ODOMETRY", odometry);
      }
      add(stamp, "SCAN", node::write_scan(scanner.scan(i, Room::hall(), motion, random)));
    }
  }

  void close() { ASSERT_TRUE(writer_.flush()); }

 private:
  bus::LogWriter writer_;
};

/// What a node published and measured while it replayed a recording.
struct Outcome {
  node::MessageCounts counts;
  nlohmann::json metrics;
  node::Health health;
  std::map<std::string, std::vector<std::vector<std::byte>>> published;
};

/// Replays `name`.lcmlog of `dir`; the results are written to out_`name` beside it.
inline Outcome replay(const fs::path& dir, const std::string& name, const Slam6dParams& params,
                      const node::MapOptions& map = {}) {
  Outcome outcome;
  const fs::path out = dir / ("out_" + name);
  fs::create_directories(out);
  {
    bus::ReplayBus bus(dir / (name + ".lcmlog"), out / "out.lcmlog");
    node::Context context{bus, outcome.counts, out};
    Slam6dNode slam(context, params, map);
    while (bus.step()) {
    }
    slam.finish();
    slam.write_results(out);
    outcome.metrics = slam.metrics();
    outcome.health = slam.health();
    EXPECT_TRUE(bus.flush());
  }
  bus::LogReader reader(out / "out.lcmlog");
  while (const bus::LogEvent* event = reader.next()) {
    outcome.published[event->channel].emplace_back(event->data.begin(), event->data.end());
  }
  return outcome;
}

inline std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace nodmap::slam6d::node_test
