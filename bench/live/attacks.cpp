// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/attacks.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/live/robot_observer.hpp"
#include "bench/live/stop_metrics.hpp"
#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/stop_t.hpp"
#include "tests/support/attacker.hpp"

namespace nodmap::bench {
namespace {

constexpr std::uint16_t kPort = 7667;  // LCM's default port
constexpr double kRateHz = 100.0;
// One message a little later than a sender may be silent.
constexpr double kListenerHz = 1.0 / 0.21;
constexpr std::int64_t kSkippedByListener = 100;
constexpr double kSeldomHz = 1.4;  // three in 1.4 s: too seldom to be noticed, also if one is late
constexpr time::Duration kAhead = 45ms;  // forged stamps are ahead, to look newest
constexpr double kDrivingMps = 0.5;    // from this speed on the robot is driving, before and after
constexpr double kTimeToStopS = 2.0;   // to notice the attack and to brake
constexpr double kStationaryM = 0.05;  // greatest distance of a robot that has stopped
// Least mean speed of a robot that drives on: one that stops again and again has 0.18 m/s.
constexpr double kDrivesOnMps = 0.3;
constexpr double kPatienceS = 120.0;  // wait for it to drive; a busy machine is slow
constexpr const char* kNeighbour = "10.9.9.9";

// Sends messages as a process of the robot would, and raw datagrams. It also listens to what the
// robot's processes send.
class Forger {
 public:
  Forger() {
    bus_.subscribe_bytes("FORGER", [this](auto) { own_ = bus_.origin().sender; });
    bus_.publish_bytes("FORGER", {});
    while (own_ == bus::Sender{}) {
      bus_.handle(std::chrono::milliseconds(100));
    }
    listen("DRIVE", &nodmap::drive_t::drive_seq);
    listen("ODOMETRY", &nodmap::odometry_t::odometry_seq);
    listen("SCAN", &nodmap::scan_t::scan_seq);
    listen("PITCH_STATE", &nodmap::pitch_state_t::state_seq);
    listen("OBSTACLE_MAP", &nodmap::egomap_t::scan_seq);
    listen("BASE_SENSORS", &nodmap::base_sensors_t::sensors_seq);
  }

  [[nodiscard]] std::int64_t next_seq() { return seq_++; }

  // The newest number of the legitimate sender.
  [[nodiscard]] std::int64_t received_seq(const std::string& channel) {
    bus_.handle(std::chrono::milliseconds(0));
    return received_seqs_[channel];
  }

  // Sends what has been received on all these channels again, with the numbers that come next.
  void repeat(const std::vector<std::string>& channels) {
    bus_.handle(std::chrono::milliseconds(0));
    for (const std::string& channel : channels) {
      if (const auto found = received_.find(channel); found != received_.end()) {
        bus_.publish_bytes(channel, found->second);
      }
    }
    received_.clear();
  }

  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    bus_.publish(channel, message);
  }

  template <class Message>
  void publish_as_neighbour(const std::string& channel, const Message& message) {
    std::vector<std::byte> bytes;
    bus::encode_into(bytes, message);
    attacker_.send_as(
        kNeighbour,
        test::datagram(channel + '\0' +
                       std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())));
  }

  void send_fragments(const std::string& channel) {
    for (const std::string& datagram : test::two_fragments_that_wrap(channel)) {
      attacker_.send(datagram);
    }
  }

 private:
  template <class Message>
  void listen(const std::string& channel, std::int64_t Message::*seq) {
    bus_.subscribe<Message>(channel, [this, channel, seq](const Message& message) {
      if (bus_.origin().sender != own_) {
        received_seqs_[channel] = message.*seq;
        Message next = message;
        ++(next.*seq);
        bus::encode_into(received_[channel], next);
      }
    });
  }

  bus::LiveBus bus_{""};
  bus::Sender own_;
  test::Attacker attacker_{kPort};
  std::int64_t seq_ = 0;
  std::map<std::string, std::int64_t> received_seqs_;  // by channel
  std::map<std::string, std::vector<std::byte>>
      received_;  // the newest message, with the next number
};

time::Timestamp now() {
  return time::SystemClock().now();
}

// Commands full speed ahead.
nodmap::drive_t forged_drive(Forger& forger, time::Duration ahead) {
  nodmap::drive_t drive{};
  drive.utime = time::to_utime(now() + ahead);
  drive.drive_seq = forger.next_seq();
  drive.forward_mps = 5.0;
  drive.valid_us = 200'000;
  return drive;
}

// Makes the laser look up and allows any speed.
nodmap::pitch_command_t forged_pitch_command(Forger& forger) {
  nodmap::pitch_command_t command{};
  command.utime = time::to_utime(now());
  command.command_seq = forger.next_seq();
  command.pitch_min_rad = 0.4;
  command.pitch_max_rad = 0.4;
  command.sweep_s = 0.5;
  command.max_forward_mps = 5.0;
  return command;
}

// Reports that the robot has not moved since its start.
nodmap::odometry_t forged_odometry(Forger& forger, time::Duration ahead) {
  nodmap::odometry_t odometry{};
  odometry.utime = time::to_utime(now() + ahead);
  odometry.odometry_seq = forger.next_seq();
  odometry.orientation[0] = 1.0;
  return odometry;
}

// The same with numbers that the legitimate sender has not reached yet.
void publish_drive_of_listener(Forger& forger, std::int64_t step) {
  nodmap::drive_t drive = forged_drive(forger, 0us);
  drive.drive_seq = forger.received_seq("DRIVE") + step;
  forger.publish("DRIVE", drive);
}

void publish_odometry_of_listener(Forger& forger, time::Duration ahead) {
  nodmap::odometry_t odometry = forged_odometry(forger, ahead);
  odometry.odometry_seq = forger.received_seq("ODOMETRY") + kSkippedByListener;
  forger.publish("ODOMETRY", odometry);
}

enum class Promise : std::uint8_t { kStationary, kDrivesOn };

struct Attack {
  std::string name;
  Promise promise = Promise::kStationary;
  std::string teller;  // the process that must report the attack in STATUS; empty: none
  std::function<void(Forger&)> strike;
  double rate_hz = kRateHz;            // 0: once
  bool restarts_stopped_pair = false;  // STOP is sent, then base driver and navigator are killed
                                       // and restarted
};

std::vector<Attack> attacks() {
  const auto one_odometry = [](Forger& forger) {
    forger.publish("ODOMETRY", forged_odometry(forger, 24h));
  };
  const auto fragments = [](Forger& forger) {
    for (const char* channel : {"SCAN", "ODOMETRY", "DRIVE", "PITCH_COMMAND", "STATUS"}) {
      forger.send_fragments(channel);
    }
  };
  const auto neighbour = [](Forger& forger) {
    forger.publish_as_neighbour("DRIVE", forged_drive(forger, 0us));
    forger.publish_as_neighbour("ODOMETRY", forged_odometry(forger, 0us));
  };
  return {
      {"DRIVE, 45 ms ahead", Promise::kStationary, "nodmap-kurt",
       [](Forger& forger) { forger.publish("DRIVE", forged_drive(forger, kAhead)); }},
      {"DRIVE, stamped rightly", Promise::kStationary, "nodmap-kurt",
       [](Forger& forger) { forger.publish("DRIVE", forged_drive(forger, 0us)); }},
      {"PITCH_COMMAND", Promise::kStationary, "nodmap-laser3d",
       [](Forger& forger) { forger.publish("PITCH_COMMAND", forged_pitch_command(forger)); }},
      {"ODOMETRY", Promise::kStationary, "nodmap-navigator",
       [](Forger& forger) { forger.publish("ODOMETRY", forged_odometry(forger, 0us)); }},
      {"one ODOMETRY, a day ahead", Promise::kDrivesOn, "", one_odometry, 0.0},
      {"DRIVE that skips numbers", Promise::kStationary, "nodmap-kurt",
       [](Forger& forger) { publish_drive_of_listener(forger, kSkippedByListener); }, kListenerHz},
      {"DRIVE with the next numbers", Promise::kStationary, "nodmap-kurt",
       [](Forger& forger) { publish_drive_of_listener(forger, 1); }},
      {"DRIVE with the next number, 1.4 a second", Promise::kDrivesOn, "",
       [](Forger& forger) { publish_drive_of_listener(forger, 1); }, kSeldomHz},
      {"the sensors' messages with the next numbers", Promise::kStationary, "nodmap-navigator",
       [](Forger& forger) {
         forger.repeat({"SCAN", "PITCH_STATE", "OBSTACLE_MAP", "BASE_SENSORS"});
       }},
      {"ODOMETRY that skips numbers", Promise::kStationary, "nodmap-navigator",
       [](Forger& forger) { publish_odometry_of_listener(forger, 0us); }, kListenerHz},
      {"ODOMETRY a day ahead that skips numbers, once a second", Promise::kDrivesOn, "",
       [](Forger& forger) { publish_odometry_of_listener(forger, 24h); }, 1.0},
      {"two datagrams that wrap", Promise::kDrivesOn, "nodmap-navigator", fragments},
      {"a neighbour's DRIVE, ODOMETRY", Promise::kDrivesOn, "nodmap-kurt", neighbour},
      {"base and navigator killed", Promise::kStationary, "", {}, 0.0, true},
  };
}

struct Outcome {
  bool drove_before = false;
  bool drove_after = false;
  std::int64_t collisions = 0;
  double driven_m = 0.0;  // from kTimeToStopS after the beginning on
  bool is_kept = false;   // whether this is as promised
  std::map<std::string, std::string> complaints;
  std::vector<std::string> dead;
};

double driven_m(const std::vector<Motion>& motions, time::Timestamp from) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < motions.size(); ++i) {
    if (motions[i - 1].stamp >= from) {
      sum_m += std::hypot(motions[i].x_m - motions[i - 1].x_m, motions[i].y_m - motions[i - 1].y_m);
    }
  }
  return sum_m;
}

// Whether the robot has been since `from` as promised.
bool is_kept(Promise promise, const std::vector<Motion>& motions, time::Timestamp from) {
  const double distance_m = driven_m(motions, from);
  return promise == Promise::kStationary
             ? distance_m < kStationaryM
             : !motions.empty() &&
                   distance_m >= kDrivesOnMps * time::seconds(motions.back().stamp - from);
}

// Attacks for `duration_s`, and then until `is_answered`, because a busy machine may react late.
void strike_until(const Attack& attack, RobotObserver& observer, double duration_s,
                  const std::function<bool()>& is_answered) {
  using Clock = std::chrono::steady_clock;
  Forger forger;
  auto next = Clock::now();
  const auto enough = next + std::chrono::duration<double>(duration_s);
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
      attack.rate_hz > 0.0 ? 1.0 / attack.rate_hz : 2.0 * (duration_s + kPatienceS)));
  observer.listen(duration_s + kPatienceS, [&] {
    for (; attack.strike && next <= Clock::now(); next += period) {
      attack.strike(forger);
    }
    return Clock::now() >= enough && is_answered();
  });
}

void stop_and_restart_pair(RobotProcesses& robot, RobotObserver& observer) {
  Forger forger;
  nodmap::stop_t stop{};
  stop.utime = time::to_utime(now());
  stop.is_stopped = 1;
  stop.requested_by = "the bench";
  forger.publish("STOP", stop);
  observer.listen(1.0);
  for (const char* name : {"kurt", "navigator"}) {
    robot.kill(name);
  }
  for (const char* name : {"kurt", "navigator"}) {
    robot.start(name);
  }
}

Outcome examine(const Attack& attack, const RobotProcesses::Options& options, double duration_s) {
  RobotObserver observer;
  RobotProcesses robot(options);
  Outcome outcome;
  outcome.drove_before = observer.listen(kPatienceS, [&] { return observer.driving(kDrivingMps); });
  static_cast<void>(observer.take_complaints());  // of the start
  const time::Timestamp from = now() + time::from_seconds(kTimeToStopS);
  if (attack.restarts_stopped_pair) {
    stop_and_restart_pair(robot, observer);
  }
  strike_until(attack, observer, duration_s, [&] {
    const bool is_told = attack.teller.empty() || observer.complaints().contains(attack.teller);
    return is_told && (attack.promise == Promise::kStationary ||
                       is_kept(attack.promise, observer.motions(), from));
  });
  outcome.driven_m = driven_m(observer.motions(), from);
  outcome.is_kept = is_kept(attack.promise, observer.motions(), from);
  outcome.complaints = observer.take_complaints();
  if (attack.restarts_stopped_pair) {
    robot.release();
  }
  outcome.drove_after = observer.listen(kPatienceS, [&] { return observer.driving(kDrivingMps); });
  outcome.collisions = observer.collisions();
  outcome.dead = robot.take_dead();
  return outcome;
}

bool keeps_promise(const Attack& attack, const Outcome& outcome) {
  return outcome.drove_before && outcome.drove_after && outcome.is_kept &&
         outcome.collisions == 0 && outcome.dead.empty() &&
         (attack.teller.empty() || outcome.complaints.contains(attack.teller));
}

// The reasons of the processes that were not OK, each with the process that gave it, or their
// number.
std::string summarize(const std::map<std::string, std::string>& complaints) {
  std::map<std::string, std::vector<std::string>> names_by_reason;
  for (const auto& [name, reason] : complaints) {
    names_by_reason[reason].push_back(name);
  }
  std::string text;
  for (const auto& [reason, names] : names_by_reason) {
    text += text.empty() ? "" : "; ";
    text += names.size() == 1 ? names.front() : std::to_string(names.size()) + " processes";
    text += ": " + reason;
  }
  return text;
}

void print(const Attack& attack, const Outcome& outcome) {
  std::printf("| %s | %lld | %.2f m | %s | %s", attack.name.c_str(),
              static_cast<long long>(outcome.collisions), outcome.driven_m,
              outcome.drove_after ? "yes" : "no", outcome.dead.empty() ? "none" : "");
  for (const std::string& name : outcome.dead) {
    std::printf("%s ", name.c_str());
  }
  std::printf(" | %s | %s |\n", summarize(outcome.complaints).c_str(),
              keeps_promise(attack, outcome) ? "ok" : "MISS");
  std::fflush(stdout);
}

}  // namespace

int run_attacks(RobotProcesses::Options options, const std::string& only, double duration_s) {
  std::printf(
      "| attack | collisions | driven after the first %.0f s | drives on afterwards | ended | "
      "STATUS | |\n"
      "|---|---|---|---|---|---|---|\n",
      kTimeToStopS);
  int missed = 0;
  const auto root = options.out;
  int number = 0;
  for (const Attack& attack : attacks()) {
    options.out = root / ("attack" + std::to_string(number++));
    if (attack.name.find(only) == std::string::npos) {
      continue;
    }
    const Outcome outcome = examine(attack, options, duration_s);
    print(attack, outcome);
    missed += keeps_promise(attack, outcome) ? 0 : 1;
  }
  return missed == 0 ? 0 : 1;
}

}  // namespace nodmap::bench
