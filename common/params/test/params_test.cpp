// SPDX-License-Identifier: BSD-3-Clause
#include "common/params/params.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <numbers>

#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::params {
namespace params_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

enum class Rule : std::uint8_t { kPaper, kConfirmed };

struct SampleParams {
  double range_m = 20.0;
  int count = 3;
  double pitch_rad = 0.5 * std::numbers::pi;
  bool save = false;
  Rule rule = Rule::kConfirmed;
  std::string device = "/dev/ttyUSB0";

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("range_m", range_m, {1.0, 80.0}, "How far.");
    v.integer("count", count, {1, 5}, "How many.");
    v.angle("pitch_deg", pitch_rad, {-90.0, 90.0}, "How high.");
    v.flag("save", save, "Whether.");
    v.choice("rule", rule, {{"paper", Rule::kPaper}, {"confirmed", Rule::kConfirmed}}, "Which.");
    v.text("device", device, "Where.");
  }
};

class ParamsTest : public ::testing::Test {
 protected:
  std::string error_of_yaml(const std::string& yaml) {
    const auto file = dir_.path() / "p.yaml";
    std::ofstream(file) << yaml;
    try {
      table_.load_yaml(file);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  }

  test::TemporaryDir dir_;
  SampleParams params_;
  Table table_{params_};
};

TEST_F(ParamsTest, LoadsEveryKind) {
  EXPECT_EQ(error_of_yaml("range_m: 4.5\ncount: 5\npitch_deg: -45\nsave: true\nrule: paper\n"
                          "device: /dev/sick\n"),
            "");
  EXPECT_EQ(params_.range_m, 4.5);
  EXPECT_EQ(params_.count, 5);
  EXPECT_DOUBLE_EQ(params_.pitch_rad, -0.25 * std::numbers::pi);
  EXPECT_TRUE(params_.save);
  EXPECT_EQ(params_.rule, Rule::kPaper);
  EXPECT_EQ(params_.device, "/dev/sick");
}

TEST_F(ParamsTest, MissingKeysKeepTheirDefaultsAndAnEmptyFileIsFine) {
  EXPECT_EQ(error_of_yaml("count: 4\n"), "");
  EXPECT_EQ(params_.range_m, 20.0);
  EXPECT_EQ(error_of_yaml("# nothing\n"), "");
}

TEST_F(ParamsTest, ErrorsNameFileLineKeyValueAndWhatIsAllowed) {
  EXPECT_THAT(error_of_yaml("count: 4\nrange_m: 100\n"),
              AllOf(HasSubstr("p.yaml:2"), HasSubstr("range_m"), HasSubstr("100"),
                    HasSubstr("from 1 to 80")));
  EXPECT_THAT(error_of_yaml("rnge_m: 10\n"),
              AllOf(HasSubstr("p.yaml:1"), HasSubstr("rnge_m"), HasSubstr("range_m")));
  EXPECT_THAT(error_of_yaml("rule: best\n"), HasSubstr("one of paper confirmed"));
  EXPECT_THAT(error_of_yaml("save: yes\n"), HasSubstr("true or false"));
  EXPECT_THAT(error_of_yaml("count: 2.5\n"), HasSubstr("a whole number from 1 to 5"));
  EXPECT_THAT(error_of_yaml("range_m: nan\n"), HasSubstr("range_m"));
  EXPECT_THAT(error_of_yaml("range_m: 5 m\n"), HasSubstr("'5 m'"));
  EXPECT_THAT(error_of_yaml("range_m: [1, 2]\n"), HasSubstr("single value"));
  EXPECT_THAT(error_of_yaml("range_m: {\n"), HasSubstr("p.yaml"));
  EXPECT_THAT(error_of_yaml("just words\n"), HasSubstr("key: value"));
}

struct CountParams {
  int bytes = 1000;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("bytes", bytes, {0, 1'000'000}, "How many.");
  }
};

TEST(Params, TheLimitsOfAWholeNumberAreWrittenAsTheyCanBeSet) {
  CountParams params;
  Table table(params);
  EXPECT_THAT(table.to_markdown(), HasSubstr("from 0 to 1000000 |"));
  table.set("bytes", "1000000", "--set");
  EXPECT_EQ(params.bytes, 1'000'000);
}

TEST_F(ParamsTest, AKeyIsSetOnceInAFileButAgainByTheNextFile) {
  EXPECT_THAT(error_of_yaml("range_m: 4\ncount: 4\nrange_m: 5\n"),
              AllOf(HasSubstr("p.yaml:3"), HasSubstr("'range_m' is already set in this file")));
  EXPECT_EQ(error_of_yaml("range_m: 6\n"), "");
  EXPECT_EQ(error_of_yaml("range_m: 7\n"), "");
  EXPECT_EQ(params_.range_m, 7.0);
}

TEST_F(ParamsTest, ASecondDocumentIsRefused) {
  EXPECT_EQ(error_of_yaml("---\nrange_m: 4\n...\n"), "");
  EXPECT_THAT(error_of_yaml("range_m: 6\n---\ncount: 4\n"), HasSubstr("another YAML document"));
  EXPECT_EQ(params_.range_m, 4.0) << "neither is used";
}

// Also where no value is in it that would be refused: by aliases, a section can contain itself, or
// each of many sections the one before it ten times.
TEST_F(ParamsTest, AnUnknownSectionIsRefused) {
  EXPECT_THAT(error_of_yaml("near: &near\n  far: *near\n"),
              AllOf(HasSubstr("p.yaml:1"), HasSubstr("unknown section 'near'")));
  EXPECT_THAT(error_of_yaml("count: 4\nnera: {}\n"),
              AllOf(HasSubstr("p.yaml:2"), HasSubstr("unknown section 'nera'")));
}

TEST_F(ParamsTest, ARefusedValueChangesNothing) {
  EXPECT_THROW(table_.set_assignment("count=6"), ParamError);
  EXPECT_THROW(table_.set_assignment("pitch_deg=91"), ParamError);
  EXPECT_THROW(table_.set_assignment("count"), ParamError);
  EXPECT_EQ(params_.count, 3);
  EXPECT_DOUBLE_EQ(params_.pitch_rad, 0.5 * std::numbers::pi);
}

TEST_F(ParamsTest, MissingFileIsAnError) {
  EXPECT_THROW(table_.load_yaml(dir_.path() / "none.yaml"), formats::InputFileError);
}

TEST_F(ParamsTest, ADumpLoadsAgain) {
  table_.set_assignment("range_m=0.1e1");
  table_.set_assignment("pitch_deg=33.3");
  table_.set_assignment("device=");
  const auto file = dir_.path() / "dump.yaml";
  std::ofstream(file) << table_.to_yaml();
  SampleParams copy;
  Table copy_table(copy);
  copy_table.load_yaml(file);
  EXPECT_EQ(copy_table.to_yaml(), table_.to_yaml());
  EXPECT_THAT(table_.to_yaml(), HasSubstr("# How far.\n# a number from 1 to 80\nrange_m: 1\n"));
  EXPECT_THAT(table_.to_markdown(), HasSubstr("| `pitch_deg` | 33.3 |"));
}

struct PartParams {
  double gain = 1.0;
  bool save_all = false;
  template <class Visitor>
  void describe(Visitor& v) {
    v.number("gain", gain, {0.0, 10.0}, "How strong.");
    v.flag("save_all", save_all, "Whether all.");
  }
};

struct NestedParams {
  int first = 1;
  PartParams near;
  PartParams far;
  int last = 2;
  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("first", first, {0, 9}, "First.");
    v.section("near", near);
    v.section("far", far);
    v.integer("last", last, {0, 9}, "Last.");
    v.renamed("near_gain", "near.gain");
  }
};

TEST(NestedTable, SetsThePartThatIsNamed) {
  NestedParams params;
  Table table(params);
  table.set_assignment("far.gain=3");
  table.set("near.save_all", "true", "test");
  EXPECT_EQ(params.far.gain, 3.0);
  EXPECT_EQ(params.near.gain, 1.0);
  EXPECT_TRUE(params.near.save_all);
  EXPECT_THROW(table.set_assignment("gain=3"), ParamError);
}

TEST(NestedTable, LoadsWhatItWritesAndDottedKeys) {
  const test::TemporaryDir dir;
  NestedParams params;
  params.first = 7;
  params.near.gain = 2.5;
  params.far.save_all = true;
  const std::string yaml = Table(params).to_yaml();
  EXPECT_THAT(yaml,
              HasSubstr("\nnear:\n  # How strong.\n  # a number from 0 to 10\n  gain: 2.5\n"));
  std::ofstream(dir.path() / "nested.yaml") << yaml;
  std::ofstream(dir.path() / "dotted.yaml") << "near.gain: 4\n";
  NestedParams loaded;
  Table table(loaded);
  table.load_yaml(dir.path() / "nested.yaml");
  EXPECT_EQ(table.to_yaml(), yaml);
  table.load_yaml(dir.path() / "dotted.yaml");
  EXPECT_EQ(loaded.near.gain, 4.0);
}

TEST(NestedTable, NestedAndDottedKeysAreTheSameKey) {
  const test::TemporaryDir dir;
  NestedParams params;
  Table table(params);
  std::ofstream(dir.path() / "twice.yaml") << "near:\n  gain: 2\nfar:\n  gain: 3\nnear.gain: 4\n";
  EXPECT_THROW(table.load_yaml(dir.path() / "twice.yaml"), ParamError);
}

TEST(NestedTable, NamesTheNewKeyOfARenamedOne) {
  NestedParams params;
  Table table(params);
  try {
    table.set_assignment("near_gain=2");
    FAIL() << "an old key was taken";
  } catch (const ParamError& error) {
    EXPECT_STREQ(error.what(), "--set: key 'near_gain' is now called 'near.gain'");
  }
}

}  // namespace params_test
}  // namespace nodmap::params
