// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/table.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "procman/sheriff/printable.hpp"

namespace nodmap::procman {

std::vector<std::string> aligned(std::span<const Column> columns,
                                 const std::vector<ReportRow>& rows, std::string_view gap) {
  std::vector<std::string> lines(rows.size() + 1);
  for (const Column& column : columns) {
    std::vector<std::string> cells{column.title};
    std::ranges::transform(rows, std::back_inserter(cells), column.cell);
    const std::size_t width = width_of(*std::ranges::max_element(cells, {}, width_of));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string blanks(width - width_of(cells[i]), ' ');
      lines[i] += column.side == Side::kLeft ? cells[i] + blanks : blanks + cells[i];
      lines[i] += gap;
    }
  }
  return lines;
}

std::string host_cell(const ReportRow& row) {
  return printable(row.deputy);
}

std::string pid_cell(const ReportRow& row) {
  return row.pid != 0 ? std::to_string(row.pid) : "";
}

std::string cpu_cell(const ReportRow& row) {
  return row.pid != 0 ? fmt::format("{:.1f}", row.cpu_percent) : "";
}

std::string memory_cell(const ReportRow& row) {
  return row.pid != 0 ? fmt::format("{:.1f}", row.memory_mb) : "";
}

std::string uptime_cell(const ReportRow& row) {
  const std::int64_t total_s = row.uptime / 1s;
  if (row.pid == 0) {
    return {};
  }
  if (total_s < 60) {
    return fmt::format("{}s", total_s);
  }
  return total_s < 3600 ? fmt::format("{}m{}s", total_s / 60, total_s % 60)
                        : fmt::format("{}h{}m", total_s / 3600, total_s % 3600 / 60);
}

std::string restarts_cell(const ReportRow& row) {
  return row.restarts > 0 ? std::to_string(row.restarts) : "";
}

std::string output_cell(const ReportRow& row) {
  return row.last_output;
}

}  // namespace nodmap::procman
