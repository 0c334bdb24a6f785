// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::doctor {

enum class Verdict : std::uint8_t { kOk, kWarn, kFail };

/// What one check has to say.
struct Finding {
  std::string check;  ///< one word or two, the same in every run
  Verdict verdict = Verdict::kOk;
  std::string sentence;
  std::string command;  ///< mends it; empty when there is nothing to mend
};

}  // namespace nodmap::doctor
