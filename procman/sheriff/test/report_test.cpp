// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "procman/config/parser.hpp"

namespace nodmap::procman {
namespace report_test {

using ::testing::HasSubstr;

class ReportTest : public ::testing::Test {
 protected:
  ReportTest() {
    DeputyInfo info;
    info.deputy_id = "h";
    info.cpu_load = 0.25F;
    CommandStatus status;
    status.spec.id = "a";
    status.pid = 4242;
    status.actual_run = 1;
    status.cpu_share = 0.125F;
    status.rss_bytes = 3'000'000;
    CommandStatus ended;
    ended.spec.id = "b";
    ended.actual_run = 1;
    ended.wait_status = 3 << 8;
    info.commands = {status, ended};
    fleet_.take_info(info, {});
    ProcessHealth health;
    health.state = ProcessHealth::State::kFailed;
    health.reason = "no\x1B[2J scans";
    health_.take_status("prog", health, fleet_, time::SteadyTime(1s));
  }
  [[nodiscard]] std::vector<ReportRow> rows(time::Duration now) const {
    Console console;
    console.take("last\tline\r\n");
    return report(fleet_, health_, {{"a", console}}, time::SteadyTime(now));
  }

  Config config_ = parse_config(R"(
      group "z" { cmd "a" { exec = "prog"; host = "h"; } }
      cmd "b" { exec = "q"; host = "h"; } cmd "c" { exec = "q"; host = "far"; })")
                       .config;
  Fleet fleet_{config_, "me:1:1"};
  HealthWatch health_{config_};
};

TEST_F(ReportTest, ShowsStateHealthAndOutputOfEachCommand) {
  const auto table = to_table(rows(3725ms));
  ASSERT_EQ(table.size(), 4U);
  EXPECT_THAT(table[1], HasSubstr("Stopped (Error), exit 3"));
  EXPECT_THAT(table[2], ::testing::AllOf(HasSubstr("far"), HasSubstr("Unknown")));
  for (const char* part :
       {"z/a", "Running", "4242", "12.5", "3.0", "3s", "FAILED: no?[2J scans", "last?line"}) {
    EXPECT_THAT(table[3], HasSubstr(part));
  }
}

// They take two bytes each.
TEST_F(ReportTest, UmlautsDoNotShiftTheColumns) {
  auto changed = rows(3725ms);
  const auto table = to_table(changed);
  changed[0].deputy = "\xC3\xA4";  // as wide as "h"
  EXPECT_EQ(to_table(changed)[1].find("Stopped"), table[1].find("Stopped") + 1) << "in bytes";
  EXPECT_EQ(to_table(changed)[3], table[3]);
}

TEST_F(ReportTest, ACommandWithoutARecentStatusIsSilent) {
  EXPECT_THAT(health_sentence(rows(4400ms).back()), HasSubstr("FAILED"));
  EXPECT_EQ(health_sentence(rows(4600ms).back()), "SILENT: no STATUS for 3 s");
  EXPECT_EQ(health_word(rows(4600ms).back()), "SILENT");
}

TEST_F(ReportTest, IsAvailableAsJson) {
  const nlohmann::json json = to_json(rows(0s), {"a\x1B"}, fleet_, {});
  EXPECT_EQ(json["commands"].size(), 3U);
  EXPECT_EQ(json["commands"][2]["command"], "a");
  EXPECT_EQ(json["commands"][2]["state"], "Running");
  EXPECT_EQ(json["commands"][0]["end"], "exit 3");
  EXPECT_EQ(json["hosts"][0]["host"], "far");
  EXPECT_EQ(json["hosts"][0]["reporting"], false);
  EXPECT_EQ(json["hosts"][1]["cpu_load"], 0.25);
  EXPECT_EQ(json["warnings"], nlohmann::json({"a?"}));
  EXPECT_NO_THROW(static_cast<void>(json.dump()));
}

}  // namespace report_test
}  // namespace nodmap::procman
