// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "procman/config/config.hpp"
#include "procman/protocol/console.hpp"
#include "procman/sheriff/report.hpp"
#include "procman/sheriff/terminal.hpp"
#include "procman/sheriff/view.hpp"

namespace nodmap::procman {

/// What a key asks the sheriff for.
struct QuitRequest {};
struct ScriptRequest {
  std::size_t index = 0;  ///< into Config::scripts; perhaps beyond its end
};
struct OrderRequest {
  Verb verb = Verb::kStart;
  std::vector<std::string> commands;
  std::string target;  ///< the command or group, for a message
};
using KeyRequest = std::variant<QuitRequest, ScriptRequest, OrderRequest>;

/// The state of the live view: the selected command and how far its output is scrolled back. Keys
/// change it, or ask for something that is left to the caller.
class LiveView {
 public:
  /// The commands to show from now on. The selection stays at its command, because a key is for
  /// what the screen showed; if that command is gone, at its line.
  void update(std::vector<ReportRow> rows);
  /// Null if there are no commands.
  [[nodiscard]] const ReportRow* selected() const;

  /// `output`: of the selected command, or null. Returns what the key asks the sheriff for.
  std::optional<KeyRequest> press(Key key, const Console* output);
  void set_message(std::string message) { state_.message = std::move(message); }

  /// The lines to draw, by to_view(). `scripts`: those of the configuration.
  [[nodiscard]] std::vector<ViewLine> lines(std::string title, const Console* output,
                                            const std::vector<Script>& scripts,
                                            Terminal::Size size);

 private:
  void select(Key key);
  void scroll(Key key, const Console* output);
  [[nodiscard]] std::optional<KeyRequest> order_of(Key key) const;

  ViewState state_;
  std::vector<ReportRow> rows_;
};

}  // namespace nodmap::procman
