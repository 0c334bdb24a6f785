// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/process_tables.hpp"

#include <gtest/gtest.h>

#include <csignal>

#include "modules/viewer/foxglove/test/robot_messages.hpp"

namespace nodmap::foxglove {
namespace process_tables_test {

procman_lcm::cmd_status_t command(const std::string& id, std::int32_t pid,
                                  std::int32_t wait_status) {
  procman_lcm::cmd_status_t status{};
  status.cmd.command_id = id;
  status.cmd.exec_str = "LEVEL=3 /opt/bin/nodmap-" + id + " --config x=y";
  status.cmd.group = "20.maps";
  status.cmd.stop_signal = SIGTERM;
  status.pid = pid;
  status.exit_code = wait_status;
  return status;
}

procman_lcm::deputy_info_t info(const std::string& host,
                                std::vector<procman_lcm::cmd_status_t> commands) {
  procman_lcm::deputy_info_t message{};
  message.utime = 5;
  message.deputy_id = host;
  message.cpu_load = -1.0F;
  message.ncmds = static_cast<std::int32_t>(commands.size());
  message.cmds = std::move(commands);
  return message;
}

TEST(CommandTable, ReportsTheStateOfCommands) {
  CommandTable table;
  ASSERT_TRUE(table.update(info("robot", {command("d", 0, SIGTERM), command("a", 17, 0),
                                          command("b", 0, 3 << 8), command("c", 0, SIGSEGV)}),
                           {}));
  const Json list = table.commands()["commands"];
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(list[0]["process_name"], "nodmap-a");
  EXPECT_EQ(list[0]["state"], "running");
  EXPECT_EQ(list[1]["state"], "failed");
  EXPECT_EQ(list[1]["end"], "exit 3");
  EXPECT_EQ(list[2]["end"], "killed by signal 11");
  EXPECT_EQ(list[3]["state"], "stopped");
  EXPECT_TRUE(table.commands()["hosts"][0]["cpu_share"].is_null());
}

TEST(CommandTable, ListsConfiguredCommandsOnce) {
  CommandTable table;
  procman::Config config;
  config.commands.resize(2);
  config.commands[0].id = "a";
  config.commands[0].exec = "nodmap-a";
  config.commands[0].group = "20.maps";
  config.commands[1].id = "z";
  config.commands[1].exec = "nodmap-z --out x";
  for (procman::Command& command : config.commands) {
    command.deputy = "robot";
  }
  table.set_configured(config);
  EXPECT_EQ(table.commands()["commands"][0]["state"], "no deputy")
      << "nothing was received from its deputy yet";
  ASSERT_TRUE(table.update(info("robot", {command("a", 17, 0)}), {}));
  const Json list = table.commands()["commands"];
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0]["command"], "z");
  EXPECT_EQ(list[0]["state"], "stopped");
  EXPECT_EQ(list[0]["process_name"], "nodmap-z");
  EXPECT_EQ(list[1]["pid"], 17);
}

TEST(CommandTable, DoesNotGrowWithInventedNames) {
  CommandTable table;
  for (std::size_t i = 0; i < CommandTable::kMaxHosts; ++i) {
    EXPECT_TRUE(table.update(info("host" + std::to_string(i), {}), {}));
  }
  EXPECT_FALSE(table.update(info("one more", {}), {}));
  EXPECT_TRUE(table.update(info("host0", {}), {}));
  EXPECT_FALSE(table.update(
      info("host0", std::vector<procman_lcm::cmd_status_t>(CommandTable::kMaxCommands + 1)), {}));
}

TEST(ProcessTable, KeepsTheNewestStatusOfEachProcessSortedByName) {
  ProcessTable table;
  nodmap::status_t status = foxglove::test::status_at(1.0);
  status.process_name = "b";
  EXPECT_TRUE(table.update(status, {}).health_changed);
  status.process_name = "a";
  table.update(status, {});
  status.health = nodmap::status_t::DEGRADED;
  EXPECT_TRUE(table.update(status, {}).health_changed);
  EXPECT_FALSE(table.update(status, {}).health_changed);
  const Json json = table.processes();
  ASSERT_EQ(json["processes"].size(), 2U);
  EXPECT_EQ(json["processes"][0]["process_name"], "a");
  EXPECT_EQ(json["processes"][0]["health"], 1);
}

// The hosts' clocks differ by ten seconds.
TEST(ProcessTable, TellsHowLongAgoAStatusWasReceivedWhateverTheSendersClocks) {
  ProcessTable table;
  nodmap::status_t status = foxglove::test::status_at(1.0);
  nodmap::status_t elsewhere = foxglove::test::status_at(11.0);
  status.process_name = "a";
  elsewhere.process_name = "b";
  const auto age_s = [&table](std::size_t i) {
    return table.processes()["processes"][i]["age_s"].get<double>();
  };
  table.update(elsewhere, time::Timestamp(100s));
  table.update(status, time::Timestamp(100s));
  EXPECT_DOUBLE_EQ(age_s(0), 0.0);
  EXPECT_DOUBLE_EQ(age_s(1), 0.0);
  table.update(status, time::Timestamp(104s));
  EXPECT_DOUBLE_EQ(age_s(0), 0.0);
  EXPECT_DOUBLE_EQ(age_s(1), 4.0);
}

TEST(ProcessTable, DoesNotGrowWithInventedNames) {
  ProcessTable table;
  nodmap::status_t status = foxglove::test::status_at(1.0);
  for (std::size_t i = 0; i < 2 * ProcessTable::kMaxProcesses; ++i) {
    status.process_name = std::string(i + 1, 'p');
    EXPECT_EQ(table.update(status, {}).taken, i < ProcessTable::kMaxProcesses);
  }
}

}  // namespace process_tables_test
}  // namespace nodmap::foxglove
