// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/node.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "common/bus/bus.hpp"
#include "common/bus/loop_bus.hpp"
#include "drivers/laser3d/test/fake_sensor.hpp"
#include "drivers/laser3d/test/fake_servo.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/scan_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::laser3d {
namespace node_test {

using serial::IoStatus;

// A line in memory: the part that it shares with the device behind it.
struct Wire {
  std::function<Bytes(const Bytes& request, int baud)> answer;
  Bytes to_host;
  Bytes request;
  int baud = 0;
  bool plugged = true;
};

class WireStream : public serial::ByteStream {
 public:
  explicit WireStream(Wire& wire) : wire_(wire) {}

  serial::ReadResult read(std::span<std::uint8_t> buffer, std::chrono::microseconds) override {
    if (!wire_.plugged) {
      return {IoStatus::kDisconnected, 0};
    }
    const std::size_t count = std::min(buffer.size(), wire_.to_host.size());
    std::copy_n(wire_.to_host.begin(), count, buffer.begin());
    wire_.to_host.erase(wire_.to_host.begin(),
                        wire_.to_host.begin() + static_cast<std::ptrdiff_t>(count));
    return {count > 0 ? IoStatus::kOk : IoStatus::kTimeout, count};
  }
  IoStatus write(std::span<const std::uint8_t> bytes, std::chrono::microseconds) override {
    if (!wire_.plugged) {
      return IoStatus::kDisconnected;
    }
    wire_.request.insert(wire_.request.end(), bytes.begin(), bytes.end());
    const Bytes answer = wire_.answer(wire_.request, wire_.baud);
    serial::append(wire_.to_host, answer);
    return IoStatus::kOk;
  }
  bool set_baud(int baud) override {
    wire_.baud = baud;
    return true;
  }
  void discard_input() override { wire_.to_host.clear(); }
  [[nodiscard]] bool connected() const override { return wire_.plugged; }
  [[nodiscard]] int poll_handle() const override { return -1; }

 private:
  Wire& wire_;
};

serial::SerialLink::Opener opener(Wire& wire) {
  return [&wire]() -> serial::OpenResult {
    if (!wire.plugged) {
      return {nullptr, "no such device"};
    }
    return {std::make_unique<WireStream>(wire), ""};
  };
}

// The process without its loop, on simulated time in steps of a millisecond.
class Rig {
 public:
  Rig()
      : context{bus, counts, {}},
        scans(bus, "SCAN"),
        pitch(bus, "PITCH_STATE"),
        node(context, Laser3dParams(), {opener(laser), opener(servo)}, [this] { return now; }) {
    laser.answer = [this](const Bytes& request, int baud) -> Bytes {
      // Requests come byte by byte at 500000.
      if (request.size() < 6 || request.size() < 6U + boost::endian::load_little_u16(&request[2])) {
        return {};
      }
      Bytes answer = sensor.answer(request, baud);
      laser.request.clear();
      return answer;
    };
    servo.answer = [this](const Bytes& request, int) {
      Bytes answer = head.answer(request);
      servo.request.clear();
      return answer;
    };
    head.registers[11] = 3;
    head.registers[117] = 2048 >> 8;
    network.set_time(now);
  }

  void run(double seconds) {
    const time::SteadyTime end = now.steady + time::from_seconds(seconds);
    for (; now.steady < end; pass(1ms)) {
      head.step_ms(static_cast<int>(now.steady.time_since_epoch() / 1ms));
      if (sensor.streaming && sensor.baud == laser.baud &&
          now.steady.time_since_epoch() % 13ms == 0ms) {
        serial::append(laser.to_host, sensor.next_scan());
      }
      node.spin_once();
      network.deliver();
    }
  }

  // The driver does nothing meanwhile, as one that is frozen.
  void pass(time::Duration duration) {
    now.steady += duration;
    now.wall += duration;
    network.set_time(now);
  }

  Wire laser;
  Wire servo;
  test::FakeSensor sensor;
  test::FakeServo head;
  time::Moment now{time::Timestamp(1'700'000'000s), time::SteadyTime(1s)};
  nodmap::test::TemporaryDir dir;
  bus::LoopNetwork network{dir.path() / "log", {}};
  bus::LoopBus bus{network};
  node::MessageCounts counts;
  node::Context context;
  bus::Latest<nodmap::scan_t> scans;
  bus::Latest<nodmap::pitch_state_t> pitch;
  Laser3dNode node;
};

TEST(Laser3dNode, PublishesScansAndPitchStampedWithTheWallClock) {
  Rig rig;
  rig.run(4.0);
  // Of 4 s the laser's start takes two; the servo answers every 5 ms almost from the beginning.
  EXPECT_GT(rig.scans.count(), 75);
  EXPECT_GT(rig.pitch.count(), 750);
  EXPECT_EQ(rig.node.health().state, node::HealthState::kOk) << rig.node.health().reason;
  const nodmap::scan_t& scan = *rig.scans.get();
  EXPECT_LE(rig.now.wall - time::from_utime(scan.utime), 60ms);
  EXPECT_GT(rig.now.wall - time::from_utime(scan.utime), 6660us);
  EXPECT_EQ(scan.num_ranges, 181);
  EXPECT_EQ(scan.pitch_is_measured, 1);
  EXPECT_LE(rig.now.wall - time::from_utime(rig.pitch.get()->utime), 10ms);
  EXPECT_EQ(rig.node.metrics()["scans"], rig.scans.get()->scan_seq + 1);
}

TEST(Laser3dNode, ObeysPitchCommandsAndRefusesOldAndBadOnes) {
  Rig rig;
  rig.run(3.0);
  nodmap::pitch_command_t command{};
  command.pitch_min_rad = -0.2;
  command.pitch_max_rad = 0.05;
  command.sweep_s = 0.5;
  for (int i = 0; i < 10; ++i) {
    command.utime = time::to_utime(rig.now.wall);
    rig.bus.publish("PITCH_COMMAND", command);
    rig.run(0.3);
  }
  EXPECT_NEAR(std::abs(rig.pitch.get()->goal_pitch_rad + 0.075), 0.125, 1e-9);
  EXPECT_EQ(rig.counts.used(), 10);
  command.utime = time::to_utime(rig.now.wall - 5s);
  rig.bus.publish("PITCH_COMMAND", command);
  for (const std::int64_t utime :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    command.utime = utime;
    rig.bus.publish("PITCH_COMMAND", command);
  }
  command.utime = time::to_utime(rig.now.wall);
  command.sweep_s = -1.0;
  rig.bus.publish("PITCH_COMMAND", command);
  rig.run(0.1);
  EXPECT_EQ(rig.counts.rejected().at("stale"), 3);
  EXPECT_EQ(rig.counts.rejected().at("no_area"), 1);
}

nodmap::pitch_command_t narrow_nod(time::Timestamp stamp) {
  nodmap::pitch_command_t command{};
  command.utime = time::to_utime(stamp);
  command.pitch_min_rad = -0.2;
  command.pitch_max_rad = 0.05;
  command.sweep_s = 0.5;
  return command;
}

// Whether the head is on its way to an end of that nod.
bool nods_narrowly(const Rig& rig) {
  return std::abs(std::abs(rig.pitch.get()->goal_pitch_rad + 0.075) - 0.125) < 1e-9;
}

// It may have waited in the queue of a busy machine. A second after it was decided the head nods as
// without commands, between -0.7 and 0.26 rad.
TEST(Laser3dNode, APitchCommandIsObeyedForASecondFromItsStamp) {
  Rig rig;
  rig.run(3.0);
  rig.bus.publish("PITCH_COMMAND", narrow_nod(rig.now.wall - 900ms));
  rig.run(0.05);
  EXPECT_TRUE(nods_narrowly(rig));
  rig.run(0.1);
  EXPECT_FALSE(nods_narrowly(rig)) << rig.pitch.get()->goal_pitch_rad;
}

// The clock of its sender is ahead.
TEST(Laser3dNode, APitchCommandFromTheFutureIsObeyedNoLonger) {
  Rig rig;
  rig.run(3.0);
  rig.bus.publish("PITCH_COMMAND", narrow_nod(rig.now.wall + 900ms));
  rig.run(0.95);
  EXPECT_TRUE(nods_narrowly(rig));
  rig.run(0.1);
  EXPECT_FALSE(nods_narrowly(rig)) << rig.pitch.get()->goal_pitch_rad;
}

TEST(Laser3dNode, AStallIsPublished) {
  Rig rig;
  rig.run(4.0);
  EXPECT_EQ(rig.pitch.get()->is_stalled, 0);
  rig.head.jammed = true;
  rig.run(0.35);
  EXPECT_EQ(rig.pitch.get()->is_stalled, 1);
}

// Its stamps are too old, so that each of its commands would be refused anyway.
TEST(Laser3dNode, ASecondSenderIsNoticedByItsStaleCommandsToo) {
  Rig rig;
  rig.run(3.0);
  bus::LoopBus other(rig.network);
  nodmap::pitch_command_t command{};
  command.pitch_min_rad = -0.2;
  command.pitch_max_rad = 0.05;
  command.sweep_s = 0.5;
  for (int i = 0; i < 20; ++i) {
    command.utime = time::to_utime(rig.now.wall);
    rig.bus.publish("PITCH_COMMAND", command);
    command.utime = time::to_utime(rig.now.wall - 5s);
    other.publish("PITCH_COMMAND", command);
    rig.run(0.02);
  }
  EXPECT_NE(rig.node.health().reason.find("two processes send PITCH_COMMAND"), std::string::npos);
}

// Frozen for half a second, longer than a sender may be silent. Somebody else's command, to point
// the laser at the ceiling, is the first that it reads then.
TEST(Laser3dNode, AFrozenDriverGoesOnFollowingItsSender) {
  Rig rig;
  rig.run(3.0);
  rig.bus.publish("PITCH_COMMAND", narrow_nod(rig.now.wall));
  rig.run(0.01);
  bus::LoopBus other(rig.network);
  nodmap::pitch_command_t forged = narrow_nod(rig.now.wall);
  forged.pitch_min_rad = forged.pitch_max_rad = 0.5;
  other.publish("PITCH_COMMAND", forged);
  for (int i = 0; i < 10; ++i) {
    rig.pass(50ms);
    rig.bus.publish("PITCH_COMMAND", narrow_nod(rig.now.wall));
  }
  rig.run(0.05);
  EXPECT_EQ(rig.counts.rejected().at("other_sender"), 1);
  EXPECT_TRUE(nods_narrowly(rig)) << rig.pitch.get()->goal_pitch_rad;
  EXPECT_NE(rig.node.health().reason,
            "two processes send PITCH_COMMAND: neither is obeyed until one has ended");
}

// A second sender points the laser at the ceiling, 50 times a second. A second after the last
// command that was obeyed the head nods as without commands, between -0.7 and 0.26 rad.
TEST(Laser3dNode, ASecondSenderOfPitchCommandIsRefusedAndReported) {
  Rig rig;
  rig.run(3.0);
  nodmap::pitch_command_t own{};
  own.pitch_min_rad = -0.2;
  own.pitch_max_rad = 0.05;
  own.sweep_s = 0.5;
  nodmap::pitch_command_t forged = own;
  forged.pitch_min_rad = forged.pitch_max_rad = 0.5;
  bus::LoopBus other(rig.network);
  auto send = [&rig, seq = std::int64_t{0}](bus::Bus& bus,
                                            nodmap::pitch_command_t& command) mutable {
    command.utime = time::to_utime(rig.now.wall);
    command.command_seq = seq++;
    bus.publish("PITCH_COMMAND", command);
  };
  for (int i = 0; i < 100; ++i) {
    send(rig.bus, own);
    rig.run(0.01);
    send(other, forged);
    rig.run(0.01);
    const double goal_rad = rig.pitch.get()->goal_pitch_rad;
    EXPECT_LT(goal_rad, 0.4);
    EXPECT_TRUE(i < 60 || goal_rad < -0.3 || goal_rad > 0.15) << i << ": " << goal_rad;
  }
  EXPECT_LT(rig.counts.used(), 5) << "until the third message of the second sender";
  EXPECT_EQ(rig.counts.rejected().at("other_sender") + rig.counts.used(), 200);
  EXPECT_EQ(rig.node.health().state, node::HealthState::kFailed);
  EXPECT_NE(rig.node.health().reason.find("two processes send PITCH_COMMAND"), std::string::npos);
  for (int i = 0; i < 100; ++i) {
    send(rig.bus, own);
    rig.run(0.02);
  }
  EXPECT_EQ(rig.node.health().state, node::HealthState::kOk) << rig.node.health().reason;
}

TEST(Laser3dNode, UnpluggingTheLaserEndsTheScansAndReplugsResumeThem) {
  Rig rig;
  rig.run(4.0);
  rig.laser.plugged = false;
  rig.run(0.05);
  EXPECT_EQ(rig.node.health().state, node::HealthState::kFailed);
  EXPECT_EQ(rig.node.health().reason.find("laser: "), 0U) << rig.node.health().reason;
  const std::int64_t scans = rig.scans.count();
  rig.run(2.0);
  EXPECT_EQ(rig.scans.count(), scans);
  rig.laser.plugged = true;
  rig.run(8.0);
  EXPECT_GT(rig.scans.count(), scans + 375);  // 5 s of the 8, as it starts again
  EXPECT_EQ(rig.node.health().state, node::HealthState::kOk) << rig.node.health().reason;
}

TEST(Laser3dNode, UnpluggingTheServoEndsTheScansAndReplugsResumeThem) {
  Rig rig;
  rig.run(4.0);
  rig.servo.plugged = false;
  rig.run(0.05);
  EXPECT_EQ(rig.node.health().reason.find("servo: "), 0U) << rig.node.health().reason;
  const std::int64_t scans = rig.scans.count();
  rig.run(2.0);
  EXPECT_EQ(rig.scans.count(), scans);
  rig.servo.plugged = true;
  rig.run(8.0);
  EXPECT_GT(rig.scans.count(), scans + 375);  // 5 s of the 8, as it starts again
}

TEST(Laser3dNode, EndsWithTheLaserAtRest) {
  Rig rig;
  rig.run(4.0);
  rig.node.shut_down();
  rig.run(0.2);
  EXPECT_TRUE(rig.node.is_shut_down());
  EXPECT_FALSE(rig.sensor.streaming);
}

}  // namespace node_test
}  // namespace nodmap::laser3d
