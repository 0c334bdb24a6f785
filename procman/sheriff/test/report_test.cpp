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

TEST_F(ReportTest, ACommandWithoutARecentStatusIsSilent) {
  EXPECT_THAT(rows(4400ms).back().health, HasSubstr("FAILED"));
  EXPECT_EQ(rows(4600ms).back().health, "SILENT: no STATUS for 3 s");
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

TEST(Printable, ReplacesControlCharactersAndInvalidUtf8) {
  EXPECT_EQ(printable("a\x1B[31m\r\n\x7F"), "a?[31m???");
  EXPECT_EQ(printable("gr\xC3\xBC\xC3\x9F \xE2\x82\xAC"), "gr\xC3\xBC\xC3\x9F \xE2\x82\xAC");
  EXPECT_EQ(printable("\xC3"), "?");
  EXPECT_EQ(printable("\xFF\xC2\x9B!"), std::string(3, '?') + "!");
  // A surrogate; a slash encoded in two and in three bytes; a code beyond the last code point; the
  // last code point.
  EXPECT_EQ(printable("\xED\xA0\x80"), std::string(3, '?'));
  EXPECT_EQ(printable("\xC0\xAF\xE0\x80\xAF"), std::string(5, '?'));
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), std::string(4, '?'));
  EXPECT_EQ(printable("\xF4\x8F\xBF\xBF"), "\xF4\x8F\xBF\xBF");
}

}  // namespace report_test
}  // namespace nodmap::procman
