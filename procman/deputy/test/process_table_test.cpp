// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/process_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace nodmap::procman {
namespace process_table_test {

constexpr std::string_view kStat =
    "4242 (a (b) c) S 17 4242 99 34816 4242 4194304 100 0 0 0 30 12 0 0 20 0 1 0 123456 4464640 "
    "739 18446744073709551615 1 1 0 0 0 0 0 0 65536 0 0 0 17 0 0 0 0 0 0";

TEST(ProcessTable, ReadsALineWithAnyProcessName) {
  const auto row = parse_process(kStat);
  ASSERT_TRUE(row.has_value());
  EXPECT_EQ(row->pid, 4242);
  EXPECT_EQ(row->parent, 17);
  EXPECT_EQ(row->session, 99);
  EXPECT_EQ(row->state, 'S');
  EXPECT_EQ(row->cpu_ticks, 42U);
  EXPECT_EQ(row->start_ticks, 123456U);
  EXPECT_EQ(row->vsize_bytes, 4464640);
  EXPECT_EQ(row->rss_pages, 739);
}

TEST(ProcessTable, ATruncatedLineIsRefused) {
  // Up to the last digit of the last field that is used.
  const std::size_t needed = kStat.find(" 739") + 2;
  for (std::size_t size = 0; size < needed; ++size) {
    EXPECT_FALSE(parse_process(kStat.substr(0, size)).has_value()) << size;
  }
}

TEST(ProcessTable, ContainsThisProcess) {
  const auto row = read_process(::getpid());
  ASSERT_TRUE(row.has_value());
  EXPECT_EQ(row->parent, ::getppid());
  EXPECT_EQ(row->session, ::getsid(0));
  const auto table = read_processes();
  EXPECT_TRUE(
      std::ranges::any_of(table, [](const ProcessRow& other) { return other.pid == ::getpid(); }));
}

TEST(ProcessTable, FindsAllProcessesOfATreeInAnyOrder) {
  const auto row = [](pid_t pid, pid_t parent, char state = 'S') {
    ProcessRow made;
    made.pid = pid;
    made.parent = parent;
    made.state = state;
    return made;
  };
  // 10 is the parent of 20, 20 of 5 and of 6 (dead), and 5 of 7; 30 is not in the tree.
  const std::vector<ProcessRow> table{row(7, 5),   row(5, 20),      row(30, 1),
                                      row(20, 10), row(6, 20, 'Z'), row(10, 1)};
  const auto is = [](pid_t pid) {
    return [pid](const ProcessRow& candidate) { return candidate.pid == pid; };
  };
  EXPECT_THAT(tree_of(table, is(10)), ::testing::UnorderedElementsAre(10, 20, 5, 7));
  EXPECT_THAT(tree_of(table, is(5)), ::testing::UnorderedElementsAre(5, 7));
  EXPECT_TRUE(tree_of(table, is(99)).empty());
}

TEST(ProcessTable, ReadsAnEnvironmentVariableOfAProcess) {
  ASSERT_NE(std::getenv("PATH"), nullptr);
  EXPECT_EQ(variable_of(::getpid(), "PATH"), std::getenv("PATH"));
  EXPECT_FALSE(variable_of(::getpid(), "PAT").has_value());
  EXPECT_FALSE(variable_of(-1, "PATH").has_value());
}

}  // namespace process_table_test
}  // namespace nodmap::procman
