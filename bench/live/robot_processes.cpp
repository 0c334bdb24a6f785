// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/robot_processes.hpp"

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "procman/config/parser.hpp"

namespace nodmap::bench {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPause(20);
constexpr int kStartPauses = 500;  // 10 s in total
constexpr int kEndPauses = 500;
constexpr std::array<const char*, 8> kRobot = {
    "laser3d", "kurt", "map-server", "pitch-controller", "navigator", "slam2d", "slam6d", "logger"};

// The real-time priorities of the processes as sim.pmd launches them, by name; 0: none.
std::map<std::string, int> realtime_priorities() {
  std::map<std::string, int> priorities;
  const auto config = procman::load_config(NODMAP_SOURCE_DIR "/procman/sim.pmd");
  for (const procman::Command& command : config.commands) {
    priorities[command.id] = command.resources.realtime;
  }
  return priorities;
}

// Starts a program. Its priority is an ordinary one if `realtime` is 0, or not permitted.
int spawn(pid_t& pid, char* const argv[], const posix_spawn_file_actions_t& actions, int realtime) {
  if (realtime != 0) {
    const sched_param priority{realtime};
    posix_spawnattr_t attributes{};
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSCHEDULER);
    ::posix_spawnattr_setschedpolicy(&attributes, SCHED_RR);
    ::posix_spawnattr_setschedparam(&attributes, &priority);
    const int error = ::posix_spawn(&pid, argv[0], &actions, &attributes, argv, environ);
    ::posix_spawnattr_destroy(&attributes);
    if (error != EPERM) {
      return error;
    }
  }
  return ::posix_spawn(&pid, argv[0], &actions, nullptr, argv, environ);
}

}  // namespace

RobotProcesses::RobotProcesses(Options options)
    : options_(std::move(options)), realtime_(realtime_priorities()) {
  std::filesystem::create_directories(options_.out);
  start("sim");
  const auto links = options_.out / "links";
  for (int i = 0; i < kStartPauses && !std::filesystem::exists(links / "base"); ++i) {
    std::this_thread::sleep_for(kPause);
  }
  for (const char* name : kRobot) {
    start(name);
  }
  release();
}

RobotProcesses::~RobotProcesses() {
  for (const auto& [name, pid] : pids_) {
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
  }
}

std::vector<std::string> RobotProcesses::command(const std::string& name) const {
  const std::string links = options_.out / "links";
  std::vector<std::string> words{options_.bin / ("nodmap-" + name)};
  if (name == "sim") {
    words.insert(words.end(), {"--world", options_.world, "--links", links});
    for (const std::string& fault : options_.faults) {
      words.insert(words.end(), {"--fault", fault});
    }
  } else if (name == "laser3d") {
    words.insert(words.end(), {"--set", "laser.device=" + links + "/laser", "--set",
                               "servo.device=" + links + "/servo"});
  } else if (name == "kurt") {
    words.insert(words.end(), {"--set", "device=" + links + "/base"});
  } else if (name == "stop") {
    words.emplace_back("--go");
  } else if (name == "logger") {
    words.insert(words.end(), {"--out", options_.out / "recording"});
  }
  return words;
}

void RobotProcesses::start(const std::string& name) {
  const std::vector<std::string> words = command(name);
  std::vector<char*> argv;
  for (const std::string& word : words) {
    argv.push_back(const_cast<char*>(word.c_str()));  // NOLINT: posix_spawn takes non-const
  }
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  ::posix_spawn_file_actions_init(&actions);
  const std::string log = options_.out / (name + ".log");
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t pid = -1;
  const int error = spawn(pid, argv.data(), actions, realtime_[name]);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error(words[0] + ": cannot be started");
  }
  pids_[name] = pid;
}

void RobotProcesses::release() {
  start("stop");  // exits by itself
}

std::vector<std::string> RobotProcesses::take_dead() {
  std::vector<std::string> dead;
  for (auto process = pids_.begin(); process != pids_.end();) {
    const bool has_ended = ::waitpid(process->second, nullptr, WNOHANG) == process->second;
    if (has_ended && process->first != "stop") {
      dead.push_back(process->first);
    }
    process = has_ended ? pids_.erase(process) : std::next(process);
  }
  return dead;
}

void RobotProcesses::kill(const std::string& name) {
  ::kill(pids_.at(name), SIGKILL);
  ::waitpid(pids_.at(name), nullptr, 0);
  pids_.erase(name);
}

bool RobotProcesses::ends_well(const std::string& name) {
  const pid_t pid = pids_.at(name);
  int status = 0;
  for (int i = 0; i < kEndPauses; ++i) {
    if (::waitpid(pid, &status, WNOHANG) == pid) {
      pids_.erase(name);
      return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    }
    std::this_thread::sleep_for(kPause);
  }
  kill(name);
  return false;
}

std::vector<std::string> RobotProcesses::stop() {
  std::vector<std::string> names;
  for (const auto& [name, pid] : pids_) {
    names.push_back(name);
    if (name != "sim") {
      ::kill(pid, SIGINT);
    }
  }
  std::vector<std::string> bad;
  const auto await = [&](const std::string& name) {
    if (!ends_well(name)) {
      bad.push_back(name);
    }
  };
  for (const std::string& name : names) {
    if (name != "sim") {
      await(name);
    }
  }
  if (pids_.contains("sim")) {
    ::kill(pids_.at("sim"), SIGINT);
    await("sim");
  }
  return bad;
}

}  // namespace nodmap::bench
