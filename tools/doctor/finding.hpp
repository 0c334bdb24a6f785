// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::doctor {

enum class Status : std::uint8_t { kOk, kWarn, kFail };

/// What one check has to say.
struct Finding {
  std::string check;  ///< one word or two, the same in every run
  Status status = Status::kOk;
  std::string sentence;
  std::string command;  ///< fixes it; empty when there is nothing to mend
};

}  // namespace nodmap::doctor
