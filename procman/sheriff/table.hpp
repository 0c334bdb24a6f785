// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "procman/sheriff/report.hpp"

namespace nodmap::procman {

enum class Side : std::uint8_t { kLeft, kRight };

/// A column of a table with one line per command.
struct Column {
  const char* title;
  Side side;
  std::string (*cell)(const ReportRow& row);  ///< a printable text
};

/// The title line and a line for each row. Each column is as wide as its widest cell, and followed
/// by `gap`.
[[nodiscard]] std::vector<std::string> aligned(std::span<const Column> columns,
                                               const std::vector<ReportRow>& rows,
                                               std::string_view gap);

// Cells; empty where a command does not run.
[[nodiscard]] std::string host_cell(const ReportRow& row);
[[nodiscard]] std::string pid_cell(const ReportRow& row);
[[nodiscard]] std::string cpu_cell(const ReportRow& row);
[[nodiscard]] std::string memory_cell(const ReportRow& row);
[[nodiscard]] std::string uptime_cell(const ReportRow& row);  ///< 5s, 2m3s, 1h4m
[[nodiscard]] std::string restarts_cell(const ReportRow& row);
[[nodiscard]] std::string output_cell(const ReportRow& row);

}  // namespace nodmap::procman
