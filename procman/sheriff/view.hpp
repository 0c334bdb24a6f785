// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "procman/protocol/console.hpp"
#include "procman/sheriff/report.hpp"

namespace nodmap::procman {

enum class Tone : std::uint8_t { kPlain, kStrong, kSelected, kWarning, kAlarm };

/// One line of the live view.
struct ViewLine {
  std::string text;
  Tone tone = Tone::kPlain;
};

struct ViewState {
  std::size_t selected = 0;
  std::string title;
  std::string message;
  std::size_t lines_back = 0;             ///< how far the output is scrolled back from its end
  std::vector<std::string> scripts = {};  ///< the scripts that the keys 1 to 9 start
};

/// The live view, at most `height` lines of fewer than `width` characters: a title, the commands by
/// group, the state and output of the selected one, a message, scripts and keys. `console`: the
/// output of the selected command, or null.
[[nodiscard]] std::vector<ViewLine> to_view(const std::vector<ReportRow>& rows,
                                            const Console* console, const ViewState& state,
                                            std::size_t width, std::size_t height);

}  // namespace nodmap::procman
