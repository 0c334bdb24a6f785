// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/run.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::node {
namespace run_test {

struct EchoParams {
  double gain = 1.0;
  bool loud = false;
  bool answers = true;
  int signal_at = 0;
  template <class Visitor>
  void describe(Visitor& v) {
    v.number("gain", gain, {0.0, 10.0}, "How strong.");
    v.flag("loud", loud, "Whether loud.");
    v.flag("answers", answers, "Whether it answers.");
    v.integer("signal_at", signal_at, {0, 100}, "At which message a signal comes; 11: at the end.");
  }
};

// Answers each odometry message: the smallest complete node.
class EchoNode : public Node {
 public:
  using Params = EchoParams;
  EchoNode(Context& context, const Params& params) : params_(params) {
    context.bus.subscribe<nodmap::odometry_t>("ODOMETRY",
                                              [this, &context](const nodmap::odometry_t& message) {
                                                context.counts.use();
                                                ++seen_;
                                                signal_if_at(seen_);
                                                context.bus.publish("ECHO", message);
                                              });
  }
  void finish() override { signal_if_at(seen_ + 1); }
  void write_results(const std::filesystem::path& dir) override {
    std::ofstream(dir / "echo.txt") << seen_;
  }
  [[nodiscard]] nlohmann::json metrics() const override {
    return {{"seen", seen_}, {"gain", params_.gain}, {"loud", params_.loud}};
  }

 private:
  void signal_if_at(int number) const {
    if (number == params_.signal_at) {
      std::raise(SIGINT);
    }
  }

  Params params_;
  int seen_ = 0;
};

int run_echo(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "nodmap-echo");
  std::vector<char*> argv;
  argv.reserve(arguments.size());
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  return run<EchoNode>(static_cast<int>(argv.size()), argv.data(), {"nodmap-echo", "Echoes."});
}

void write_log(const std::filesystem::path& file) {
  bus::LogWriter writer(file);
  std::vector<std::byte> bytes;
  for (int i = 0; i < 10; ++i) {
    nodmap::odometry_t message{};
    message.utime = i;
    bus::encode_into(bytes, message);
    ASSERT_TRUE(writer.write(std::int64_t{1'000'000} * i, "ODOMETRY", bytes));
  }
  ASSERT_TRUE(writer.write(9'000'001, "ODOMETRY", std::span(bytes).first(20)));
}

std::string slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

TEST(Run, ReplayWritesResultsAndTheSameBytesTwice) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_log(log);
  ASSERT_EQ(run_echo({"--replay", log, "--out", dir.path() / "a", "--set", "gain=2", "--loud"}), 0);
  ASSERT_EQ(run_echo({"--replay", log, "--out", dir.path() / "b"}), 0);
  EXPECT_EQ(slurp(dir.path() / "a" / "echo.txt"), "10");
  EXPECT_EQ(slurp(dir.path() / "a" / "out.lcmlog"), slurp(dir.path() / "b" / "out.lcmlog"));
  const auto result = nlohmann::json::parse(slurp(dir.path() / "a" / "result.json"));
  EXPECT_EQ(result["messages"]["read"], 10);
  EXPECT_EQ(result["messages"]["used"], 10);
  EXPECT_EQ(result["messages"]["corrupt"], 1);
  EXPECT_EQ(result["messages"]["published"], 10);
  EXPECT_EQ(result["metrics"]["gain"], 2.0);
  EXPECT_EQ(result["metrics"]["loud"], true);
  EXPECT_GT(result["realtime_factor"], 0.0);
}

nlohmann::json result_in(const std::filesystem::path& dir) {
  return nlohmann::json::parse(slurp(dir / "result.json"));
}

// A script must not go on with a part of the map as if it were the map.
TEST(Run, AnInterruptedReplayFailsAfterItHasWrittenTheResults) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_log(log);
  EXPECT_EQ(run_echo({"--replay", log, "--out", dir.path() / "a", "--set", "signal_at=5"}), 1);
  EXPECT_EQ(slurp(dir.path() / "a" / "echo.txt"), "5");
  EXPECT_EQ(result_in(dir.path() / "a")["interrupted"], true);
}

TEST(Run, ASignalAfterTheLastMessageOfAReplayChangesNothing) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_log(log);
  EXPECT_EQ(run_echo({"--replay", log, "--out", dir.path() / "a", "--set", "signal_at=11"}), 0);
  EXPECT_EQ(result_in(dir.path() / "a")["interrupted"], false);
}

TEST(Run, AReplayThatUsedNothingFails) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  {
    bus::LogWriter writer(log);
    ASSERT_TRUE(writer.write(1, "NOBODYS", std::vector<std::byte>(20)));
  }
  EXPECT_EQ(run_echo({"--replay", log, "--out", dir.path() / "a"}), 1);
  EXPECT_EQ(result_in(dir.path() / "a")["messages"]["used"], 0);
}

TEST(Run, LaterConfigurationsOverrideAndAssignmentsOverrideAll) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_log(log);
  std::ofstream(dir.path() / "robot.yaml") << "gain: 3\nloud: true\n";
  std::ofstream(dir.path() / "mine.yaml") << "gain: 4\n";
  const auto metrics_of = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> args = {"--replay", log, "--out", dir.path() / out};
    args.insert(args.end(), more.begin(), more.end());
    EXPECT_EQ(run_echo(args), 0);
    return nlohmann::json::parse(slurp(dir.path() / out / "result.json"))["metrics"];
  };
  const std::vector<std::string> both = {"--config", dir.path() / "robot.yaml", "--config",
                                         dir.path() / "mine.yaml"};
  EXPECT_EQ(metrics_of("a", both)["gain"], 4.0);
  EXPECT_EQ(metrics_of("b", both)["loud"], true);
  EXPECT_EQ(metrics_of("c", {both[2], both[3], both[0], both[1]})["gain"], 3.0);
  EXPECT_EQ(metrics_of("d", {"--set", "gain=5", both[0], both[1]})["gain"], 5.0);
}

TEST(Run, ExitCodesDistinguishUserErrors) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_log(log);
  EXPECT_EQ(run_echo({"--help"}), 0);
  EXPECT_EQ(run_echo({"--version"}), 0);
  EXPECT_EQ(run_echo({"--dump-params"}), 0);
  EXPECT_EQ(run_echo({"--no-such-option"}), 2);
  EXPECT_EQ(run_echo({"--loud", "--dump-params"}), 0);
  EXPECT_EQ(run_echo({"--loud=false", "--dump-params"}), 2) << "must not be taken and ignored";
  EXPECT_EQ(run_echo({"--answers", "--dump-params"}), 2) << "it is true already";
  EXPECT_EQ(run_echo({"--set", "gain=11"}), 2);
  EXPECT_EQ(run_echo({"--set", "gian=1"}), 2);
  EXPECT_EQ(run_echo({"--config", dir.path() / "none.yaml"}), 2);
  EXPECT_EQ(run_echo({"--log-level", "chatty"}), 2);
  EXPECT_EQ(run_echo({"--replay", log}), 2);  // where to?
  EXPECT_EQ(run_echo({"--replay", dir.path() / "none", "--out", dir.path() / "c"}), 2);
  std::ofstream(dir.path() / "precious") << "x";
  EXPECT_EQ(run_echo({"--replay", log, "--out", dir.path()}), 2);  // not empty
}

TEST(StopSignals, EachOfThemRequestsTheEnd) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    catch_stop_signals();
    EXPECT_FALSE(stop_requested());
    std::raise(signal);
    EXPECT_TRUE(stop_requested()) << signal;
  }
  catch_stop_signals();  // forgets the last one
}

TEST(StopSignals, UnderNohupAClosedTerminalIsNone) {
  std::signal(SIGHUP, SIG_IGN);
  catch_stop_signals();
  std::raise(SIGHUP);
  EXPECT_FALSE(stop_requested());
  std::signal(SIGHUP, SIG_DFL);
}

}  // namespace run_test
}  // namespace nodmap::node
