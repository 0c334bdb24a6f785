// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "procman/protocol/control_sequences.hpp"

namespace nodmap::procman {

/// The output of one command as it is printed: first its last output, then what follows. Each
/// function returns what is to be printed next.
class OutputFollower {
 public:
  /// Without colours, control sequences are left out.
  explicit OutputFollower(bool has_colours) : has_colours_(has_colours) {}

  /// Takes the last output. Only the first counts: deputies repeat it for other sheriffs.
  [[nodiscard]] std::string take_last(std::string_view text);
  /// Takes new output. Until the last output has come it waits: that contains it.
  [[nodiscard]] std::string take(std::string_view text);
  /// Waits for the last output no longer: a deputy of the existing procman sends none, nor does
  /// ours if there is none.
  [[nodiscard]] std::string stop_waiting();

 private:
  [[nodiscard]] std::string shown(std::string_view text);

  bool has_colours_;
  bool is_waiting_ = true;
  std::string waiting_;  // new output
  ControlSequences sequences_;
};

}  // namespace nodmap::procman
