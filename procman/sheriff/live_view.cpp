// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/live_view.hpp"

#include <algorithm>
#include <array>

namespace nodmap::procman {
namespace {

constexpr std::size_t kScrollLines = 5;
constexpr std::size_t kMaxScripts = 9;  // the number of keys

// The order of a key, for the selected command or for its whole group.
struct KeyOrder {
  Key key;
  Verb verb;
  bool is_for_group;
};
constexpr std::array<KeyOrder, 6> kKeyOrders{{{Key::kStart, Verb::kStart, false},
                                              {Key::kStop, Verb::kStop, false},
                                              {Key::kRestart, Verb::kRestart, false},
                                              {Key::kStartGroup, Verb::kStart, true},
                                              {Key::kStopGroup, Verb::kStop, true},
                                              {Key::kRestartGroup, Verb::kRestart, true}}};

}  // namespace

void LiveView::update(std::vector<ReportRow> rows) {
  const ReportRow* before = selected();
  const auto same = std::ranges::find_if(rows, [&](const ReportRow& row) {
    return before != nullptr && row.id == before->id && row.deputy == before->deputy;
  });
  if (same != rows.end()) {
    state_.selected = static_cast<std::size_t>(same - rows.begin());
  } else {
    state_.selected = std::min(state_.selected, rows.empty() ? 0 : rows.size() - 1);
    state_.lines_back = 0;
  }
  rows_ = std::move(rows);
}

const ReportRow* LiveView::selected() const {
  return rows_.empty() ? nullptr : &rows_[state_.selected];
}

std::optional<KeyRequest> LiveView::press(Key key, const Console* output) {
  switch (key) {
    case Key::kUp:
    case Key::kDown:
      select(key);
      return std::nullopt;
    case Key::kPageUp:
    case Key::kPageDown:
      scroll(key, output);
      return std::nullopt;
    case Key::kQuit:
      return QuitRequest{};
    default:
      break;
  }
  if (key >= Key::kFirstScript && key <= Key::kLastScript) {
    return ScriptRequest{static_cast<std::size_t>(key) -
                         static_cast<std::size_t>(Key::kFirstScript)};
  }
  return order_of(key);
}

std::vector<ViewLine> LiveView::lines(std::string title, const Console* output,
                                      const std::vector<Script>& scripts, Terminal::Size size) {
  state_.title = std::move(title);
  state_.scripts.clear();
  for (const Script& script : scripts) {
    if (state_.scripts.size() < kMaxScripts) {
      state_.scripts.push_back(script.name);
    }
  }
  return to_view(rows_, output, state_, size.width, size.height);
}

void LiveView::select(Key key) {
  if (key == Key::kUp) {
    state_.selected -= state_.selected > 0 ? 1 : 0;
  } else {
    state_.selected += state_.selected + 1 < rows_.size() ? 1 : 0;
  }
  state_.lines_back = 0;
}

void LiveView::scroll(Key key, const Console* output) {
  const std::size_t most = output == nullptr ? 0 : output->lines().size();
  state_.lines_back = key == Key::kPageUp
                          ? std::min(state_.lines_back + kScrollLines, most)
                          : state_.lines_back - std::min(state_.lines_back, kScrollLines);
}

std::optional<KeyRequest> LiveView::order_of(Key key) const {
  const auto* const order = std::ranges::find(kKeyOrders, key, &KeyOrder::key);
  if (order == kKeyOrders.end() || rows_.empty()) {
    return std::nullopt;
  }
  const ReportRow& target = *selected();
  const bool is_for_group = order->is_for_group && !target.group.empty();
  OrderRequest request{order->verb, {}, is_for_group ? target.group : target.id};
  for (const ReportRow& row : rows_) {
    if (is_for_group ? is_in_group(row.group, target.group) : row.id == target.id) {
      request.commands.push_back(row.id);
    }
  }
  return request;
}

}  // namespace nodmap::procman
