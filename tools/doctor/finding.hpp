// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::doctor {

enum class Status : std::uint8_t { kOk, kWarn, kFail };

/// The result of one check.
struct Finding {
  std::string check;  ///< one word or two, the same in every run
  Status status = Status::kOk;
  std::string sentence;
  std::string command;  ///< command that fixes it; empty if there is nothing to fix
};

}  // namespace nodmap::doctor
