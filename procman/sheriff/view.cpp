// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/view.hpp"

#include <algorithm>
#include <string>

#include "procman/sheriff/printable.hpp"
#include "procman/sheriff/table.hpp"

namespace nodmap::procman {
namespace {

constexpr std::size_t kFrameLines = 4;  // title, message, scripts, keys
constexpr std::size_t kMinPaneLines = 4;
const std::string kKeysLine =
    "up/down PgUp/PgDn  s start  t stop  r restart  S T R its group  q quit";

std::string name_cell(const ReportRow& row) {
  return "  " + printable(row.id);
}

std::string state_cell(const ReportRow& row) {
  return short_name_of(row.state);
}

constexpr Column kColumns[] = {
    {"COMMAND", Side::kLeft, name_cell},       {"HOST", Side::kLeft, host_cell},
    {"STATE", Side::kLeft, state_cell},        {"HEALTH", Side::kLeft, health_word},
    {"PID", Side::kRight, pid_cell},           {"CPU%", Side::kRight, cpu_cell},
    {"MB", Side::kRight, memory_cell},         {"UP", Side::kRight, uptime_cell},
    {"RESTARTS", Side::kRight, restarts_cell}, {"LAST OUTPUT", Side::kLeft, output_cell},
};

Tone tone_of(const ReportRow& row) {
  const auto says = [&row](ProcessHealth::State state) {
    return row.health && !is_silent(row) && row.health->state == state;
  };
  if (row.state == CommandState::kStoppedError || says(ProcessHealth::State::kFailed)) {
    return Tone::kAlarm;
  }
  const bool is_well = row.state == CommandState::kRunning || row.state == CommandState::kStoppedOk;
  const bool says_well = !row.health || says(ProcessHealth::State::kOk);
  return is_well && says_well ? Tone::kPlain : Tone::kWarning;
}

// The table of the commands, below the names of their groups. Sets `selected_line` to the line of
// the selected one.
std::vector<ViewLine> table_of(const std::vector<ReportRow>& rows, std::size_t selected,
                               std::size_t& selected_line) {
  const std::vector<std::string> lines = aligned(kColumns, rows, " ");
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

// `room` lines of a table around the selected one, including the header.
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

// The state of one command, and its output up to `lines_back` lines before its end.
std::vector<ViewLine> pane_of(const ReportRow& row, const Console* console, std::size_t lines_back,
                              std::size_t room) {
  if (room == 0) {
    return {};
  }
  std::vector<ViewLine> pane{{"--- " + printable(row.id), Tone::kStrong}};
  if (console != nullptr) {
    const auto& lines = console->lines();
    const std::size_t first_end = std::min(lines.size(), room - 1);  // scrolled to the start
    const std::size_t end = std::max(first_end, lines.size() - std::min(lines.size(), lines_back));
    for (std::size_t i = end - first_end; i < end; ++i) {
      pane.push_back({printable(lines[i])});
    }
    if (end < lines.size()) {
      pane.front().text += ", " + std::to_string(lines.size() - end) + " lines below";
    }
  }
  pane.front().text += ": " + state_sentence(row);
  pane.front().text += row.health ? "; " + health_sentence(row) : "";
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
