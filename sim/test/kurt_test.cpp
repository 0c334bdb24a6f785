// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "sim/devices/kurt_base.hpp"
#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace kurt_test {

using test::at;
using test::Host;
using test::text_bytes;

constexpr const char* kHardStop = "t001800000103FF0103FF\r";
constexpr const char* kHalfMps = "t00180002003200320001\r";
constexpr const char* kTurn = "t00180002FFEC00140001\r";
constexpr const char* kZero = "t00180002000000000001\r";
constexpr const char* kReset = "t0018FFFF000000000000\r";
constexpr double kMPerTick = 0.379 / 21'950.0;

// The answers to lines sent one after the other.
std::string answers(SlcanAdapter& adapter, const std::string& said) {
  std::string answer;
  for (const char c : said) {
    answer += adapter.take(c);
  }
  return answer;
}

TEST(SlcanAdapter, AnswersAreAsInTheManual) {
  int frames = 0;
  SlcanAdapter adapter([&frames](const CanFrame& /*frame*/) { ++frames; });
  EXPECT_EQ(answers(adapter, "\r\r\rC\r"), "\r\r\r\a") << "the bus is closed already";
  EXPECT_EQ(answers(adapter, "V\rN\r"), "V1013\rN4242\r");
  EXPECT_EQ(answers(adapter, "O\r"), "\a") << "no rate has been set";
  EXPECT_EQ(answers(adapter, "S9\rS8\rZ0\r"), "\a\r\r");
  EXPECT_EQ(answers(adapter, kZero), "\a") << "the bus is closed";
  EXPECT_EQ(answers(adapter, "O\rS8\rF\r"), "\r\aF00\r");
  EXPECT_EQ(answers(adapter, kZero), "z\r");
  EXPECT_EQ(frames, 1);
  EXPECT_EQ(answers(adapter, "T12ABCDEF2AA55\rr1230\rt1230\rt4563112233\r"), "Z\rz\rz\rz\r");
  EXPECT_EQ(frames, 3) << "the base accepts data frames with short identifiers only";
  EXPECT_EQ(answers(adapter, "C\rX0\rO\rt1230\r"), "\r\r\r\r") << "without auto poll";
}

TEST(SlcanAdapter, RefusesInvalidLines) {
  SlcanAdapter adapter([](const CanFrame& /*frame*/) { ADD_FAILURE(); });
  answers(adapter, "S8\rO\r");
  for (const char* line : {"t\r", "t12\r", "t1239\r", "t1232AA\r", "t1231GG\r", "t12311122\r",
                           "q\r", "t00180002000000000001t00180002000000000001\r", "F0\r"}) {
    EXPECT_EQ(answers(adapter, line), "\a") << line;
  }
}

TEST(SlcanAdapter, AListenerSendsNothing) {
  SlcanAdapter adapter([](const CanFrame& /*frame*/) { ADD_FAILURE(); });
  EXPECT_EQ(answers(adapter, "S8\rL\rt1230\r"), "\r\r\a");
  EXPECT_EQ(adapter.from_bus({0x009, 0, {}}, at(0s)), "t0090\r");
}

TEST(SlcanAdapter, AtAnotherCanRateNoFramesArrive) {
  SlcanAdapter adapter([](const CanFrame& /*frame*/) { ADD_FAILURE(); });
  EXPECT_EQ(answers(adapter, std::string("S6\rO\r") + kZero + "F\r"), "\r\rz\rF80\r");
  EXPECT_EQ(adapter.from_bus({}, at(0s)), "");
}

TEST(SlcanAdapter, FramesAreWrittenAsInTheManual) {
  SlcanAdapter adapter([](const CanFrame& /*frame*/) {});
  const CanFrame encoders{0x009, 8, {0x00, 0x64, 0xFF, 0x9C, 0, 0, 0, 0}};
  EXPECT_EQ(adapter.from_bus(encoders, at(0s)), "") << "the bus is closed";
  answers(adapter, "S8\rO\r");
  EXPECT_EQ(adapter.from_bus(encoders, at(1234ms)), "t00980064FF9C00000000\r");
  answers(adapter, "C\rZ1\rO\r");
  EXPECT_EQ(adapter.from_bus(encoders, at(1234ms)), "t00980064FF9C0000000004D2\r");
  EXPECT_EQ(adapter.from_bus({0x009, 0, {}}, at(60'001ms)), "t00900001\r")
      << "the stamp wraps at a minute";
}

class KurtTest : public ::testing::Test {
 protected:
  KurtTest() {
    host_.before_each([this](time::SteadyTime now) { model_.advance_to(now); });
    say("S8\rO\r");
  }

  void say(const std::string& text) { host_.send(text_bytes(text)); }

  // Sends a line every 10 ms, as the driver does.
  void drive(const std::string& line, time::Duration duration) {
    for (std::int64_t i = 0; i < duration / 10ms; ++i) {
      say(line);
      listen(10ms);
    }
  }

  void listen(time::Duration duration) {
    const Bytes bytes = host_.bytes_for(duration);
    received_.append(bytes.begin(), bytes.end());
  }

  // The data of all frames of a kind received so far, as two-byte words.
  std::vector<std::array<int, 4>> frames(const std::string& id) const {
    std::vector<std::array<int, 4>> found;
    const std::string start = "t" + id + "8";
    for (std::size_t at = received_.find(start); at != std::string::npos;
         at = received_.find(start, at + 1)) {
      if (received_.find('\r', at) != at + 21) {
        continue;
      }
      std::array<int, 4> words{};
      for (std::size_t i = 0; i < 4; ++i) {
        words[i] = std::stoi(received_.substr(at + 5 + 4 * i, 4), nullptr, 16);
      }
      found.push_back(words);
    }
    return found;
  }

  static int i16(int word) { return word >= 0x8000 ? word - 0x10000 : word; }

  RobotModel model_{World{}, {}, 1};
  SlcanKurtBase kurt_{{}, model_};
  Host host_{kurt_, 1'000'000};
  std::string received_;
};

TEST_F(KurtTest, SendsEncoderFramesEveryTenMilliseconds) {
  drive(kZero, 10s);
  EXPECT_EQ(frames("009").size(), 999U) << "its clock is 20 ppm slow: 0.2 ms in 10 s";
  for (const char* id : {"005", "006", "007", "008", "00C", "00D", "00E"}) {
    EXPECT_NEAR(static_cast<double>(frames(id).size()), 1000.0 / 7.0, 1.0) << id;
  }
}

// No tick is lost or added: the sum of all reported ticks is the distance of the wheels.
TEST_F(KurtTest, RemaindersOfTicksAreCarriedToTheNextFrame) {
  drive("t00180002000700030001\r", 5s);  // 7 and 3 cm/s: no whole ticks per period
  std::int64_t left = 0;
  std::int64_t right = 0;
  std::set<int> deltas;
  for (const auto& words : frames("009")) {
    left += i16(words[0]);
    right += i16(words[1]);
    deltas.insert(i16(words[1]));
  }
  // The last period (at most 7 cm/s * 10 ms = 41 ticks) has not been reported yet.
  EXPECT_NEAR(static_cast<double>(left), model_.wheel_travel().left_m / kMPerTick, 42.0);
  EXPECT_NEAR(static_cast<double>(right), model_.wheel_travel().right_m / kMPerTick, 42.0);
  EXPECT_GT(left, 10'000);
  EXPECT_GT(deltas.size(), 1U) << "17.4 ticks are reported as 17 or 18";
}

TEST_F(KurtTest, DrivesAtTheCommandedSpeed) {
  constexpr double kRounding = 1e-9;  // after 3 s the motors' lag is over
  drive(kHalfMps, 3s);
  EXPECT_NEAR(model_.wheel_speeds().left_mps, 0.5, kRounding);
  EXPECT_NEAR(model_.wheel_speeds().right_mps, 0.5, kRounding);
  drive(kTurn, 3s);
  EXPECT_NEAR(model_.wheel_speeds().left_mps, -0.2, kRounding);
  EXPECT_NEAR(model_.wheel_speeds().right_mps, 0.2, kRounding);
  drive("t00180001001D001D0000\r", 3s);  // 29 ticks per period
  EXPECT_NEAR(model_.wheel_speeds().left_mps, 29 * kMPerTick / 0.01, kRounding);
  // Duty 103 of 1023, left wheel backwards, right wheel forwards; full duty is 5.2 m/s.
  drive("t00180000020398000398\r", 3s);
  EXPECT_NEAR(model_.wheel_speeds().left_mps, -5.2 * 103.0 / 1023.0, kRounding);
  EXPECT_NEAR(model_.wheel_speeds().right_mps, 5.2 * 103.0 / 1023.0, kRounding);
}

TEST_F(KurtTest, BrakesOnAHardStop) {
  drive(kHalfMps, 2s);
  drive(kHardStop, 1s);
  EXPECT_EQ(model_.wheel_speeds().left_mps, 0.0);
}

TEST_F(KurtTest, StopsWhenCommandsStop) {
  drive(kHalfMps, 2s);
  listen(80ms);  // 90 ms since the last command
  EXPECT_NEAR(model_.wheel_speeds().left_mps, 0.5, 1e-12);
  listen(1500ms);
  EXPECT_NEAR(model_.wheel_speeds().left_mps, 0.0, 1e-13);  // the motors' lag leaves 5e-14
}

TEST_F(KurtTest, AResetStopsTheMotorsAndSilencesTheBaseForAWhile) {
  drive(kHalfMps, 1s);
  received_.clear();
  say(kReset);
  listen(200ms);
  EXPECT_TRUE(frames("009").empty());
  listen(800ms);
  EXPECT_EQ(frames("009").size(), 79U);
  // The motors' lag leaves 1e-9 of 0.5 m/s after a second.
  EXPECT_NEAR(model_.wheel_speeds().left_mps, 0.0, 1.3e-9);
}

TEST_F(KurtTest, AStationaryRobotReportsPlausibleReadings) {
  drive(kZero, 1s);
  ASSERT_FALSE(frames("00D").empty());
  for (const auto& tilt : frames("00D")) {
    EXPECT_EQ(tilt[0], 32'768);
    EXPECT_EQ(tilt[1], 32'768);
  }
  ASSERT_FALSE(frames("006").empty());
  for (const auto& ranges : frames("006")) {
    EXPECT_LT(ranges[0], 100) << "below 100 means nothing in view";
    EXPECT_GT(ranges[1], 1000);
  }
}

TEST_F(KurtTest, TheGyroFollowsTheRobotsRotation) {
  drive(kTurn, 1s);
  const auto angle = frames("00E").back();
  const auto raw = static_cast<std::int32_t>(static_cast<std::uint32_t>(angle[0]) << 16U |
                                             static_cast<std::uint32_t>(angle[1]));
  const Eigen::Matrix3d rotation = model_.ground_truth().T_world_base.linear();
  const double yaw_deg = std::atan2(rotation(1, 0), rotation(0, 0)) * 180.0 / M_PI;
  // The frame is up to 70 ms old, and its bytes take their time.
  const double rate_deg_s = geometry::rad_to_deg(model_.ground_truth().yaw_rate_rad_s);
  EXPECT_LE(raw / 4'992'511.0, yaw_deg);
  EXPECT_GE(raw / 4'992'511.0, yaw_deg - 0.08 * rate_deg_s);
}

TEST_F(KurtTest, AtAnotherBaudRateItReceivesOnlyNoise) {
  host_.set_baud(115'200);
  received_.clear();
  listen(100ms);
  EXPECT_TRUE(frames("009").empty());
  say("C\r");
  host_.set_baud(1'000'000);
  received_.clear();
  listen(100ms);
  EXPECT_EQ(frames("009").size(), 10U) << "the channel is still open";
}

// The words of a frame of each kind.
std::map<int, std::array<int, 4>> all_readings(const KurtBaseParams& params, RobotModel& model) {
  KurtBase base(params, model, {}, 1);
  std::map<int, std::array<int, 4>> words;
  for (int i = 0; i < 14; ++i) {
    const CanFrame frame = base.next_frame();
    for (std::size_t word = 0; word < 4; ++word) {
      words[frame.id][word] = frame.data[2 * word] << 8 | frame.data[2 * word + 1];
    }
  }
  return words;
}

// A box behind, a box on the left and a person behind on the right; readings are converted as in
// the base's manual. A reading is a whole number, so 0.25 cm at 45 cm.
TEST(Kurt, InfraredRangeFindersMeasureNearObjects) {
  World world;
  world.objects.push_back({Box{{-0.217 - 0.4 - 0.5, 0.0, 0.5}, {1.0, 0.2, 1.0}, 0.0}});
  world.objects.push_back({Box{{0.0, 0.165 + 0.2 + 0.5, 0.5}, {0.2, 1.0, 1.0}, 0.0}});
  Actor person;
  person.radius_m = 0.25;
  const double away_m = std::sqrt(0.5) * (0.3 + person.radius_m);
  person.path = {{0.0, {-0.203 - away_m, -0.153 - away_m}}};
  world.actors.push_back(person);
  RobotModel model(world, {}, 1);
  auto words = all_readings({}, model);
  const auto range_m = [](int raw) {
    return 0.01 * (std::pow(30'000.0 / (raw - 10.0), 1.0 / 1.4) - 10.0);
  };
  constexpr double kToleranceM = 0.0025;
  EXPECT_NEAR(range_m(words[0x005][0]), 0.4, kToleranceM) << "back";
  EXPECT_NEAR(range_m(words[0x005][1]), 0.3, kToleranceM) << "back on the right";
  EXPECT_NEAR(range_m(words[0x006][3]), 0.2, kToleranceM) << "left";
  for (const int far : {words[0x005][2], words[0x006][0], words[0x006][2], words[0x007][1]}) {
    EXPECT_LT(far, 100) << "below 100 means nothing in view";
  }
}

TEST(Kurt, ABaseWithoutInfraredRangeFindersSeesNothing) {
  World world;
  world.objects.push_back({Box{{-0.225 - 0.3 - 0.5, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.0}});
  RobotModel model(world, {}, 1);
  EXPECT_GT(all_readings({}, model)[0x005][0], 100);
  auto words = all_readings({.has_infrared = false}, model);
  for (const int reading : {words[0x005][0], words[0x005][1], words[0x005][2], words[0x006][0],
                            words[0x006][2], words[0x006][3], words[0x007][1]}) {
    EXPECT_LT(reading, 100) << "below 100 means nothing in view";
  }
}

// A robot that neither slips nor tilts.
RobotModelParams level_params() {
  RobotModelParams params;
  params.drive.slip_distance_m = 0.0;
  params.drive.slip_heading_rad = 0.0;
  params.drive.slip_turning_rad = 0.0;
  params.drive.tilt_per_mps2_rad = 0.0;
  params.drive.ground_tilt_rad = 0.0;
  return params;
}

// An accelerometer that is to show 1 g as 3932.
TEST(Kurt, ATiltSensorThatFeelsAccelerationTakesItForTilt) {
  constexpr double kMps2 = 9.81 / 3932.0;
  constexpr std::size_t kRoll = 0;
  constexpr std::size_t kPitch = 1;
  const KurtBaseParams feels{.tilt_feels_acceleration = true};
  RobotModel model({}, level_params(), 1);
  model.set_wheel_speeds({0.9, 1.1});
  model.advance_to(at(49ms));
  const double before_mps = model.ground_truth().forward_mps;
  model.advance_to(at(50ms));
  const double ahead_mps2 = 1000.0 * (model.ground_truth().forward_mps - before_mps);
  ASSERT_GT(ahead_mps2, 3.0);
  EXPECT_EQ(all_readings({}, model)[0x00D][kPitch], 32'768);
  // The speeds are means over a millisecond, in which the acceleration changes by 2 %.
  EXPECT_NEAR((all_readings(feels, model)[0x00D][kPitch] - 32'768) * kMps2, ahead_mps2, 0.1);
  model.advance_to(at(3s));
  const GroundTruth truth = model.ground_truth();
  const double left_mps2 = truth.forward_mps * truth.yaw_rate_rad_s;
  ASSERT_GT(left_mps2, 0.4);
  auto words = all_readings(feels, model);
  EXPECT_NEAR((words[0x00D][kRoll] - 32'768) * kMps2, left_mps2, kMps2);
  EXPECT_EQ(words[0x00D][kPitch], 32'768);
}

double gyro_yaw_deg(KurtBase& base) {
  CanFrame frame;
  while (frame.id != 0x00E) {
    frame = base.next_frame();
  }
  std::uint32_t word = 0;  // big-endian
  for (std::size_t i = 0; i < 4; ++i) {
    word = word << 8U | frame.data[i];
  }
  return static_cast<std::int32_t>(word) / 4'992'511.0;
}

TEST(Kurt, TheGyroHasItsBiasAndNoise) {
  RobotModel model({}, {}, 1);
  YawGyroParams exact{};
  exact.bias_rad_s = exact.bias_walk_rad_s = exact.random_walk_rad = exact.noise_rad = 0.0;
  KurtBaseParams with_bias{.gyro = exact};
  with_bias.gyro.bias_rad_s = geometry::deg_to_rad(0.5);
  KurtBaseParams with_noise{.gyro = exact};
  with_noise.gyro.noise_rad = geometry::deg_to_rad(0.2);
  KurtBase biased(with_bias, model, {}, 1);
  KurtBase noisy(with_noise, model, {}, 1);
  model.advance_to(at(10s));
  EXPECT_NEAR(gyro_yaw_deg(biased), 5.0, 1e-6) << "since the gyro was reset";
  double sum_sq = 0.0;
  constexpr int kReadings = 2000;
  for (int i = 0; i < kReadings; ++i) {
    sum_sq += std::pow(gyro_yaw_deg(noisy), 2);
  }
  // The estimate of a deviation errs by 1 / sqrt(2 n) = 1.6 %; four times that.
  EXPECT_NEAR(std::sqrt(sum_sq / kReadings), 0.2, 0.013);
}

TEST(Kurt, TheSameCommandsGiveTheSameFrames) {
  const auto run = [] {
    RobotModel model(World{}, {}, 7);
    SlcanKurtBase kurt({}, model);
    Host host(kurt, 1'000'000);
    host.before_each([&model](time::SteadyTime now) { model.advance_to(now); });
    Bytes all = host.ask(text_bytes("S8\rO\r"), 10ms);
    for (int i = 0; i < 200; ++i) {
      append(all, host.ask(text_bytes(kTurn), 10ms));
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace kurt_test
}  // namespace nodmap::sim
