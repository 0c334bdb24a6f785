// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/view.hpp"

#include <algorithm>
#include <array>

namespace nodmap::procman {
namespace {

constexpr std::size_t kFrameLines = 4;  // title, message, scripts, keys
constexpr std::size_t kMinPaneLines = 4;
const std::string kKeysLine =
    "up/down PgUp/PgDn  s start  t stop  r restart  S T R its group  q quit";

enum class Side : std::uint8_t { kLeft, kRight };
struct Column {
  const char* title;
  Side side;
};
constexpr std::array<Column, 10> kColumns{{{"COMMAND", Side::kLeft},
                                           {"HOST", Side::kLeft},
                                           {"STATE", Side::kLeft},
                                           {"HEALTH", Side::kLeft},
                                           {"PID", Side::kRight},
                                           {"CPU%", Side::kRight},
                                           {"MB", Side::kRight},
                                           {"UP", Side::kRight},
                                           {"RESTARTS", Side::kRight},
                                           {"LAST OUTPUT", Side::kLeft}}};
using Cells = std::array<std::string, kColumns.size()>;

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // not a continuation byte
  }));
}

/// The first `width` characters. `text` is printable().
std::string fitted(const std::string& text, std::size_t width) {
  std::size_t at = 0;
  std::size_t count = 0;
  for (; at < text.size(); ++at) {
    count += (static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U ? 1 : 0;
    if (count > width) {
      break;
    }
  }
  return text.substr(0, at);
}

Cells cells_of(const ReportRow& row) {
  const bool runs = row.pid != 0;
  std::string state = name_of(row.state);
  state = state.substr(0, state.find(" (Command Sent)"));
  return {"  " + printable(row.id),
          printable(row.deputy),
          std::move(state),
          runs ? row.health.substr(0, row.health.find_first_of(": ")) : "",
          runs ? std::to_string(row.pid) : "",
          runs ? fixed(row.cpu_percent, 1) : "",
          runs ? fixed(row.memory_mb, 1) : "",
          runs ? duration(row.uptime_s) : "",
          row.restarts > 0 ? std::to_string(row.restarts) : "",
          row.last_output};
}

/// Joins the cells of each row; each column is as wide as its widest cell.
std::vector<std::string> aligned(const std::vector<Cells>& table) {
  std::array<std::size_t, kColumns.size()> widths{};
  for (const Cells& cells : table) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      widths.at(i) = std::max(widths.at(i), width_of(cells.at(i)));
    }
  }
  std::vector<std::string> lines;
  for (const Cells& cells : table) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string gap(widths.at(i) - width_of(cells.at(i)), ' ');
      line += kColumns.at(i).side == Side::kLeft ? cells.at(i) + gap : gap + cells.at(i);
      line += ' ';
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

Tone tone_of(const ReportRow& row) {
  const bool runs = row.pid != 0;
  if (row.state == CommandState::kStoppedError || (runs && row.health.starts_with("FAILED"))) {
    return Tone::kAlarm;
  }
  const bool is_well = row.state == CommandState::kRunning || row.state == CommandState::kStoppedOk;
  const bool says_well = !runs || row.health.empty() || row.health.starts_with("OK");
  return is_well && says_well ? Tone::kPlain : Tone::kWarning;
}

/// The table of the commands, below the names of their groups. Sets `selected_line` to the line of
/// the selected one.
std::vector<ViewLine> table_of(const std::vector<ReportRow>& rows, std::size_t selected,
                               std::size_t& selected_line) {
  std::vector<Cells> table{{}};
  std::transform(kColumns.begin(), kColumns.end(), table.front().begin(),
                 [](const Column& column) { return column.title; });
  std::transform(rows.begin(), rows.end(), std::back_inserter(table), cells_of);
  const std::vector<std::string> lines = aligned(table);
  std::vector<ViewLine> view;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].group.empty() && (i == 0 || rows[i].group != rows[i - 1].group)) {
      view.push_back({printable(rows[i].group), Tone::kStrong});
    }
    ViewLine line{lines[i + 1], i == selected ? Tone::kSelected : tone_of(rows[i])};
    if (i == selected) {
      selected_line = view.size();
      line.text.front() = '>';
    }
    view.push_back(std::move(line));
  }
  view.insert(view.begin(), {lines.front(), Tone::kStrong});
  ++selected_line;
  return view;
}

/// `room` lines of a table around the selected one, including the header.
std::vector<ViewLine> window_of(const std::vector<ViewLine>& table, std::size_t selected_line,
                                std::size_t room) {
  if (table.size() <= room || room < 2) {
    return {table.begin(),
            table.begin() + static_cast<std::ptrdiff_t>(std::min(room, table.size()))};
  }
  const std::size_t body = room - 1;
  const std::size_t first = selected_line <= body ? 1 : selected_line - body + 1;
  std::vector<ViewLine> window{table.front()};
  const auto begin = table.begin() + static_cast<std::ptrdiff_t>(first);
  const std::size_t size = std::min(body, table.size() - first);
  window.insert(window.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
  return window;
}

/// The state of one command, and its output up to `lines_back` lines before its end.
std::vector<ViewLine> pane_of(const ReportRow& row, const Console* console, std::size_t lines_back,
                              std::size_t room) {
  if (room == 0) {
    return {};
  }
  std::string about = "--- " + printable(row.id) + ": " + name_of(row.state);
  about += row.end.empty() ? "" : ", " + row.end;
  about += row.pid == 0 || row.health.empty() ? "" : "; " + row.health;
  std::vector<ViewLine> pane{{about, Tone::kStrong}};
  if (console != nullptr) {
    const auto& lines = console->lines();
    const std::size_t first_end = std::min(lines.size(), room - 1);  // scrolled to the start
    const std::size_t end = std::max(first_end, lines.size() - std::min(lines.size(), lines_back));
    for (std::size_t i = end - first_end; i < end; ++i) {
      pane.push_back({printable(lines[i])});
    }
    if (end < lines.size()) {
      pane.front().text += "; " + std::to_string(lines.size() - end) + " lines below";
    }
  }
  pane.resize(room);
  return pane;
}

std::string scripts_line(const std::vector<std::string>& scripts) {
  std::string line = scripts.empty() ? "" : "scripts:";
  for (std::size_t i = 0; i < scripts.size(); ++i) {
    line += "  " + std::to_string(i + 1) + " " + printable(scripts[i]);
  }
  return line;
}

}  // namespace

std::vector<ViewLine> to_view(const std::vector<ReportRow>& rows, const Console* console,
                              const ViewState& state, std::size_t width, std::size_t height) {
  std::size_t selected_line = 0;
  const std::vector<ViewLine> table = table_of(rows, state.selected, selected_line);
  const std::size_t body = height > kFrameLines ? height - kFrameLines : 0;
  const std::size_t pane_room =
      std::max(body - std::min(body, table.size()), std::min(kMinPaneLines, body / 3));
  std::vector<ViewLine> view{{state.title, Tone::kStrong}};
  const auto append = [&view](const std::vector<ViewLine>& lines) {
    view.insert(view.end(), lines.begin(), lines.end());
  };
  append(window_of(table, selected_line, body - pane_room));
  if (state.selected < rows.size()) {
    append(pane_of(rows[state.selected], console, state.lines_back, pane_room));
  }
  view.push_back({state.message, Tone::kWarning});
  view.push_back({scripts_line(state.scripts)});
  view.push_back({kKeysLine});
  view.resize(std::min(view.size(), height));
  for (ViewLine& line : view) {
    // The last column stays empty, because terminals differ in what they do after writing there.
    line.text = fitted(line.text, width > 0 ? width - 1 : 0);
  }
  return view;
}

}  // namespace nodmap::procman
